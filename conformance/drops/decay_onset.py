"""Onset of the linear decay, tested by the poles.

First, all poles must be modes. Droppers that slacken at the start of a part cause poles that decay within a second or
two, much faster than modes. The linear decay then begins when these poles have died out.

Second, the poles of the whole part must agree with those of every later part. A dropper that slackens during the
fitted part biases the poles, and poles without a mode represent the disturbance. If the line is linear, the estimate
from the whole part is efficient: the difference to an estimate from a later part has the difference of both
covariances [1]. Each estimate is one Gauss-Newton step from the fitted poles.

References:
    [1] J. A. Hausman, Specification tests in econometrics, Econometrica 46 (1978) 1251-1271. doi:10.2307/1913827
"""

from dataclasses import dataclass, replace
from itertools import takewhile

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.decay_preparation import REMEDY, PreparedDecay
from pantocheck.conformance.drops.line_fit import UNCERTAIN, FittedBlock, LineFit
from pantocheck.conformance.drops.pole_refinement import bound_estimates, build_normal_equations
from pantocheck.conformance.drops.projection import DataBlock, Noise, build_block, whiten

FAST = 5.0
"""Decay rate and damping ratio over the median of the certain modes, above which a pole is a transient [-]."""
FEWEST_CERTAIN = 5
"""Fewest certain modes that show how fast modes decay."""
SHORTEST_DELAY, LONGEST_DELAY = 1.0, 8.0
"""Limits of the time until transients have died out [s]."""
DELAYS = (0.0, 1.0, 2.0, 3.5, 5.5, 8.0, 12.0, 18.0, 27.0, 40.0)
"""Times that are left out at the start of a decay [s]."""
SHORTEST_SHARE = 0.6
"""Smallest share of a decay that is compared [-]."""
ALARM = 1e-4
"""Probability of a difference by noise alone."""
ALONE = 6.0
"""Difference of a single value over its standard deviation, above which a part is not linear [-]."""
INFORMATIVE = 3.0
"""Largest standard deviation of a value of a later part over that of the whole part [-]."""


@dataclass(frozen=True)
class DecayOnset:
    """Start of a decay whose poles agree with those of every later start."""

    delay: float | None
    """Time after the present start [s]; None: no later start is linear."""
    excess: float
    """Mean squared difference of the poles from those of a later start, over its expectation for noise [-]."""
    transients: int = 0
    """Number of poles that decay too fast for modes; the poles are compared only if there are none."""


NO_DELAY = DecayOnset(0.0, 0.0)
"""Onset of a decay that is used as it is."""


def find_onset(fit: LineFit) -> DecayOnset:
    """Find the earliest start of the decays of a fit from which their poles agree with those of every later start.

    If poles are transients, the onset is the time at which they have died out.
    """
    if (transients := find_transients(fit)).any():
        return DecayOnset(_find_silence(fit, transients), 0.0, int(transients.sum()))
    delays = list(takewhile(lambda delay: all(_determines(block, delay) for block in fit.blocks), DELAYS))
    if len(delays) < 2:
        return NO_DELAY
    estimates = [_estimate(fit, delay) for delay in delays]
    ratios = [
        max((_compare(early, late) for late in estimates[number + 1 :]), default=0.0)
        for number, early in enumerate(estimates)
    ]
    first = next((number for number, ratio in enumerate(ratios[:-1]) if ratio < 1), None)
    return DecayOnset(None if first is None else DELAYS[first], ratios[0])


def find_transients(fit: LineFit) -> NDArray[np.bool_]:
    """Mask of the poles in the reported band that decay much faster than the certain modes, (m,)."""
    rate, modulus = -fit.poles.real, np.abs(fit.poles)
    inside = (modulus >= 2 * np.pi * fit.band.low) & (modulus <= 2 * np.pi * fit.band.high)
    certain = inside & (np.sqrt(np.diag(fit.covariance)[: rate.size]) < UNCERTAIN * rate)
    if certain.sum() < FEWEST_CERTAIN:
        return np.zeros(rate.size, dtype=np.bool_)
    ratio = rate / modulus
    return np.asarray(inside & (rate > FAST * np.median(rate[certain])) & (ratio > FAST * np.median(ratio[certain])))


def _find_silence(fit: LineFit, transients: NDArray[np.bool_]) -> float:
    """Time until the residues of transients are below their standard deviation [s]."""
    times = [
        np.log(np.max(np.abs(block.fit.residues[transients]) / block.residue_std[transients], axis=1))
        / -fit.poles.real[transients]
        for block in fit.blocks
    ]
    return float(np.clip(np.max(times), SHORTEST_DELAY, LONGEST_DELAY))


def _determines(block: FittedBlock, delay: float) -> bool:
    """Whether a block without its first part [s] is long enough, and has more lines than unknowns."""
    share, unknowns = 1 - delay / block.data.duration, 2 * len(block.fit.residues) + block.data.residual_terms.shape[1]
    return share >= SHORTEST_SHARE and 2 * block.data.lines.size * share > 1.2 * unknowns


def _estimate(fit: LineFit, delay: float) -> tuple[RealArray, RealArray]:
    """Change of decay rates and angular frequencies of the reported poles without the first part [s]; variances."""
    cut = [_cut_block(fit, block, delay) for block in fit.blocks]
    equations = build_normal_equations(fit.poles, whiten([data for data, _ in cut], [noise for _, noise in cut]))
    matrix = equations.matrix + np.diag(bound_estimates(fit.poles))
    scale = np.sqrt(np.diag(matrix))
    inverse = np.linalg.inv(matrix / np.outer(scale, scale))
    frequency = np.abs(fit.poles) / (2 * np.pi)
    inside = np.tile((frequency >= fit.band.low) & (frequency <= fit.band.high), 2)
    return (inverse @ (equations.gradient / scale) / scale)[inside], (np.diag(inverse) / scale**2)[inside]


def _cut_block(fit: LineFit, block: FittedBlock, delay: float) -> tuple[DataBlock, Noise]:
    """Block without the first part, and its noise."""
    parts = [record.decay.linear.samples for record in fit.records if record.block is block]
    skipped = round(delay / block.data.dt)
    samples = np.hstack([part[skipped : block.data.n] for part in parts])
    shorter = np.sqrt(samples.shape[0] / block.data.n)
    noise: Noise = block.noise * shorter
    if block.process is not None:
        noise = replace(block.process, shapes=block.process.shapes * shorter, floor=block.process.floor * shorter)
    return build_block(samples, block.data.dt, fit.band.low, fit.band.fitted), noise


def _compare(early: tuple[RealArray, RealArray], late: tuple[RealArray, RealArray]) -> float:
    """Squared difference of two estimates over its largest value by noise, mean or single; above 1, they differ."""
    (a, variance), (b, later) = early, late
    used: NDArray[np.bool_] = (later < INFORMATIVE**2 * variance) & (later > 1.02 * variance)
    count = max(int(used.sum()), 1)
    squares = (b - a)[used] ** 2 / (later - variance)[used]
    # Values of close modes are correlated: two count as one.
    usual = float(scipy.special.chdtri(count / 2, ALARM) / (count / 2))
    return max(float(squares.sum()) / count / usual, float(squares.max(initial=0.0)) / ALONE**2)


def move_onset(decay: PreparedDecay, used: PreparedDecay, delay: float) -> PreparedDecay:
    """Start a decay later, by a delay [s] after the decay that was used in its place.

    Beside ambient motion, that decay reaches to the end of the record. It is cut if it is much longer.
    """
    late = used.linear.start + delay - decay.linear.start
    is_short = decay.linear.duration - late < (used.linear.duration - delay) / 2
    return _delay_onset(used, delay) if is_short else _delay_onset(decay, late)


def restore_onset(new: PreparedDecay, old: PreparedDecay) -> PreparedDecay:
    """Start the decay of a corrected record at the onset that was found before the correction."""
    late = old.linear.start - new.linear.start
    return _delay_onset(new, late) if old.is_cut and late > 0 else new


def _delay_onset(decay: PreparedDecay, late: float) -> PreparedDecay:
    linear, skipped = decay.linear, round(late / decay.linear.dt)
    shift = skipped * linear.dt
    name = decay.record.name
    warning = (
        f"{name}: used from {linear.start + shift - decay.release.time:.1f} s after the release: with an earlier "
        "start, the modes differ from those of the later decay, or poles decay faster than modes"
    )
    kept = tuple(text for text in decay.warnings if not text.startswith(f"{name}: used from"))
    later = replace(linear, samples=linear.samples[skipped:], start=linear.start + shift, first=linear.first + shift)
    return replace(decay, linear=later, lateral=decay.lateral[skipped:], warnings=(*kept, warning), is_cut=True)


def refuse_onset(decay: PreparedDecay, found: DecayOnset) -> InputError:
    """Error of a record without a linear part."""
    measured = (
        f"needs {count_noun(found.transients, 'pole')} with more than {FAST:g} times the decay of its modes"
        if found.transients
        else f"has other modes than its later parts: they differ {found.excess:.1f} times as much as noise explains"
    )
    return InputError(
        decay.record.name,
        f"is not a linear decay: the part from {decay.linear.start - decay.release.time:.0f} s after the release "
        f"{measured}",
        REMEDY,
    )
