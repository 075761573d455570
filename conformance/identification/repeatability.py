"""Whether a drop repeats: records laid over each other at the start and a minute later."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.decay_filters import complete_overlap, low_pass_decay
from pantocheck.conformance.identification.decay_preparation import PreparedDecay

WINDOW = 10.0  # compared at a time [s]
LATER = 60.0  # after the release [s]
LEAST_AT_START, LEAST_LATER = 0.98, 0.95  # correlations of a repeatable drop, noise allowed for
HIGHEST = 6.0  # compared below this [Hz]


@dataclass(frozen=True)
class Comparison:
    """Two records of one drop at one sensor.

    Parameters
    ----------
    first, second : str
        Names of the records.
    channel : str
        Name of the channel.
    correlation : tuple[float, float or None]
        At the start and a minute later; None if the records are too short for it.
    possible : tuple[float, float or None]
        The correlation that noise alone would leave, at the same times.
    residual : tuple[float, float or None]
        Root mean square of the difference over that of the first record, at the same times.
    shift : float
        By which the second was moved to lie over the first [s].
    """

    first: str
    second: str
    channel: str
    correlation: tuple[float, float | None]
    possible: tuple[float, float | None]
    residual: tuple[float, float | None]
    shift: float


@dataclass(frozen=True)
class Repeatability:
    """All comparisons of one test's repeats, and the verdict."""

    comparisons: tuple[Comparison, ...]
    verdict: Literal["repeatable", "not repeatable"]
    reason: str


def compare_records(repeats: tuple[PreparedDecay, ...]) -> Repeatability | None:
    """Compare every repeat with the first one.

    Parameters
    ----------
    repeats : tuple[PreparedDecay, ...]
        Records of one drop; None comes back for fewer than two.

    Returns
    -------
    Repeatability or None
        Comparisons of each further record with the first, for each sensor.
    """
    if len(repeats) < 2:
        return None
    found = [one for other in repeats[1:] for one in _compared(repeats[0], other)]
    worst = min(found, key=lambda c: c.correlation[0] / c.possible[0])
    failed = [c for c in found if not _repeats(c)]
    if failed:
        bad = failed[0]
        later = f", {bad.correlation[1]:.3f} a minute later" if bad.correlation[1] is not None else ""
        reason = f"{bad.second}, channel {bad.channel}: correlation {bad.correlation[0]:.3f} at the start{later}"
        return Repeatability(tuple(found), "not repeatable", reason)
    return Repeatability(
        tuple(found), "repeatable", f"lowest correlation at the start {worst.correlation[0]:.4f} ({worst.channel})"
    )


def _repeats(c: Comparison) -> bool:
    early = c.correlation[0] >= LEAST_AT_START * c.possible[0]
    late = c.correlation[1] is None or c.possible[1] is None or c.correlation[1] >= LEAST_LATER * c.possible[1]
    return early and late


def align_records(one: PreparedDecay, lowest_rate: float) -> tuple[RealArray, RealArray]:
    """Time from the release [s], (n,), and the vertical channels below `HIGHEST`, (n, c).

    Parameters
    ----------
    one : PreparedDecay
        a record.
    lowest_rate : float
        Samples per second of the slowest record it is compared with [Hz]; it may not reach `HIGHEST`.
    """
    rate, passes = one.record.rate, min(HIGHEST, 0.28 * lowest_rate)
    taps = low_pass_decay(rate, passes, 1.5 * passes, 50.0)
    samples = complete_overlap(one.record.signals[:, list(one.columns)], taps)
    time = (np.arange(samples.shape[0]) + (taps.size - 1) / 2) / rate - one.release.time
    return np.asarray(time, dtype=np.float64), samples


def _compared(first: PreparedDecay, second: PreparedDecay) -> list[Comparison]:
    lowest_rate = min(first.record.rate, second.record.rate)
    t1, x1 = align_records(first, lowest_rate)
    t2, x2 = align_records(second, lowest_rate)
    rate = first.record.rate
    start = 1.5  # the first second differs by how the droppers slacken
    shift = _shift(t1, x1, t2, x2, start, rate)
    noise = [_noise(t, x) for t, x in ((t1, x1), (t2, x2))]
    found = []
    for c, column in enumerate(first.columns):
        values: list[tuple[float, float, float] | None] = []
        for begin in (start, LATER):
            grid = begin + np.arange(int(WINDOW * rate)) / rate
            if grid[-1] > min(t1[-1], t2[-1] - shift):
                values.append(None)
                continue
            a = np.interp(grid, t1, x1[:, c])
            b = np.interp(grid + shift, t2, x2[:, c])
            a, b = a - a.mean(), b - b.mean()
            signal = [max(float(np.mean(v**2)) - s[c] ** 2, 0.0) for v, s in ((a, noise[0]), (b, noise[1]))]
            share = [p / (p + s[c] ** 2) if p > 0 else 0.0 for p, s in zip(signal, noise, strict=True)]
            correlation = float(a @ b / np.sqrt((a @ a) * (b @ b)))
            values.append(
                (
                    correlation,
                    float(np.sqrt(share[0] * share[1])),
                    float(np.sqrt(np.mean((a - b) ** 2) / np.mean(a**2))),
                )
            )
        early, late = values
        if early is None:
            continue
        late_or_none = late if late is not None else (None, None, None)
        found.append(
            Comparison(
                first.record.name,
                second.record.name,
                first.record.channels[column].name,
                (early[0], late_or_none[0]),
                (max(early[1], 1e-6), late_or_none[1]),
                (early[2], late_or_none[2]),
                shift,
            )
        )
    return found


def _noise(time: RealArray, samples: RealArray) -> RealArray:
    """Root mean square at rest, (c,); 0 if the record has no rest."""
    rest = samples[time < -1.0]
    return np.asarray(rest.std(axis=0)) if rest.shape[0] > 20 else np.zeros(samples.shape[1])


def _shift(t1: RealArray, x1: RealArray, t2: RealArray, x2: RealArray, start: float, rate: float) -> float:
    """Time by which the second record lags, from all channels together, to a fraction of a sample [s]."""
    grid = start + np.arange(int(WINDOW * rate)) / rate
    a = np.column_stack([np.interp(grid, t1, column) for column in x1.T])
    a = a - a.mean(axis=0)

    def likeness(shift: float) -> float:
        b = np.column_stack([np.interp(grid + shift, t2, column) for column in x2.T])
        b = b - b.mean(axis=0)
        return float(np.sum(a * b) / np.sqrt(np.sum(a**2) * np.sum(b**2)))

    shifts = np.arange(-0.3, 0.3, 0.5 / rate)
    values = [likeness(s) for s in shifts]
    k = int(np.clip(np.argmax(values), 1, shifts.size - 2))
    below, middle, above = values[k - 1 : k + 2]
    curvature = below - 2 * middle + above
    return float(shifts[k] + (0.5 * (below - above) / curvature * (shifts[1] - shifts[0]) if curvature < 0 else 0.0))
