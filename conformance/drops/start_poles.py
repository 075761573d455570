"""Start poles: subspace identification (eigensystem realization algorithm) in narrow, decimated bands.

Each band is shifted to zero frequency, low-pass filtered and decimated. Only samples at full overlap with the filter
are kept, so that every decay keeps its pole. The order of a band is that with the lowest Bayesian information
criterion of the fitted signal; poles without decay are left out.

References:
    [1] J. N. Juang, R. S. Pappa, An eigensystem realization algorithm for modal parameter identification and model
        reduction, J. Guidance 8 (1985) 620-627. doi:10.2514/3.20031
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.linalg

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import filter_full_overlap, low_pass_taps

BAND = 1.0
"""Width of a band [Hz]."""

LARGEST_ORDER = 24
"""Largest number of poles in a band and its flanks."""


@dataclass(frozen=True)
class BandTrials:
    """Poles of all orders in one band."""

    low: float
    high: float
    """Edges of the band [Hz]."""
    poles: tuple[ComplexArray, ...]
    """Poles in the band for the orders 1, 2, ..., an order being the number of poles in the band and its flanks,
    each (m,) [1/s].
    """
    selected: int
    """Order with the lowest Bayesian information criterion; 0 if there is none."""

    @property
    def start_poles(self) -> ComplexArray:
        """Poles of the selected order."""
        return self.poles[self.selected - 1] if self.selected else np.zeros(0, dtype=np.complex128)


def find_start_poles(records: list[RealArray], rate: float, low: float, high: float) -> ComplexArray:
    """Find the poles between two frequencies, band by band.

    Args:
        records: Channels over the linear decay of each record, scaled to unit variance, each (n, c); all records have
            the same poles.
        rate: Sampling rate [Hz].
        low, high: Edges of the frequency range [Hz].

    Returns:
        Poles, in the order of frequency, (m,) [1/s].
    """
    return join_start_poles(try_orders(records, rate, low, high))


def join_start_poles(trials: tuple[BandTrials, ...]) -> ComplexArray:
    """Poles of the selected orders of all bands, in the order of frequency [1/s]."""
    poles = np.concatenate([band.start_poles for band in trials])
    return np.asarray(poles[np.argsort(poles.imag)])


def try_orders(records: list[RealArray], rate: float, low: float, high: float) -> tuple[BandTrials, ...]:
    """Compute the poles of every order band by band, and select the order of each; parameters as `find_start_poles`."""
    edges = np.linspace(low, high, max(1, round((high - low) / BAND)) + 1)
    return tuple(_try_band_orders(records, rate, float(a), float(b)) for a, b in pairwise(edges))


def _try_band_orders(records: list[RealArray], rate: float, low: float, high: float) -> BandTrials:
    width = high - low
    # A narrow flank needs a long filter, which may take at most a tenth of the record.
    flank = max(0.4 * width, 25.0 * rate / min(samples.shape[0] for samples in records))
    middle = 2 * np.pi * (low + high) / 2
    step = max(1, int(rate / (width + 2.5 * flank)))
    taps = low_pass_taps(rate, width / 2 + 0.1 * flank, width / 2 + flank, 60.0)
    signals = []
    for samples in records:
        shifted = samples * np.exp(-1j * middle * np.arange(samples.shape[0]) / rate)[:, None]
        signals.append(filter_full_overlap(shifted, taps)[::step])
    dt = step / rate
    basis = _signal_subspace(signals)
    trials = [_subspace_poles(basis[:, :order], dt) for order in range(1, basis.shape[1] + 1)]
    scores = [_information_criterion(signals, poles, dt) for poles in trials]
    selected = 1 + int(np.argmin(scores)) if scores else 0
    return BandTrials(low, high, tuple(_keep_in_band(poles + 1j * middle, low, high) for poles in trials), selected)


def _keep_in_band(poles: ComplexArray, low: float, high: float) -> ComplexArray:
    """Poles with a decay in a band [Hz]."""
    inside = (poles.imag >= 2 * np.pi * low) & (poles.imag < 2 * np.pi * high) & (poles.real < 0)
    # Faster decays are shorter than the filter: they are flanks of other modes.
    return np.asarray(poles[inside & (-poles.real < 0.1 * poles.imag)])


def _signal_subspace(signals: list[ComplexArray]) -> ComplexArray:
    """Leading left singular vectors of the block Hankel matrix of all channels, (rows, at most `LARGEST_ORDER`)."""
    rows = min(signal.shape[0] for signal in signals) // 2
    gram = np.zeros((rows, rows), dtype=np.complex128)
    for signal in signals:
        for channel in signal.T:
            hankel = scipy.linalg.hankel(channel[:rows], channel[rows - 1 :])
            gram += hankel @ hankel.conj().T
    vectors = np.linalg.eigh(gram)[1]
    return np.asarray(vectors[:, ::-1][:, : min(LARGEST_ORDER, rows // 2)])


def _subspace_poles(basis: ComplexArray, dt: float) -> ComplexArray:
    """Poles of the signals in a subspace, relative to the middle of the band [1/s]."""
    transition = np.linalg.lstsq(basis[:-1], basis[1:], rcond=None)[0]
    q = np.linalg.eigvals(transition)
    return np.asarray(np.log(q[np.abs(q) > 0]) / dt)


def _information_criterion(signals: list[ComplexArray], poles: ComplexArray, dt: float) -> float:
    """Bayesian information criterion of the signals fitted by the poles; the lowest is best."""
    shortest = min(signal.shape[0] for signal in signals)
    decays = poles[poles.real < 5.0 / (shortest * dt)]
    score, values, channels = 0.0, 0, 0
    for signal in signals:
        n = signal.shape[0]
        q = np.linalg.qr(np.exp(np.outer(np.arange(n) * dt, decays)))[0]
        left = np.sum(np.abs(signal - q @ (q.conj().T @ signal)) ** 2, axis=0)
        score += float(2 * n * np.sum(np.log(left / n)))
        values += 2 * n * signal.shape[1]
        channels += signal.shape[1]
    return float(score + 2 * decays.size * (1 + channels) * np.log(values))
