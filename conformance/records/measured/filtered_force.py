"""Recognising a force that the measuring chain has low-passed at 20 Hz."""

from dataclasses import replace

import numpy as np
from scipy.signal import welch

from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.records.measured.pooled_signals import PooledSignals

FILTERED_RATIO = 0.08
"""Rms at 30-50 Hz over rms at 5-20 Hz below which a force has been low-passed, whatever its sidecar says.

The force of the reference simulator has 0.26 to 0.40 there (EN 50318:2002 at 250 and 300 km/h, AC simple at
320 km/h), and 0.02 to 0.08 after a filter of order 4 or 6 at 20 Hz. If a sidecar says "none" and is right, nothing but
the numbers above 20 Hz is lost."""


def detect_filtered(pooled: PooledSignals, who: str, warnings: list[str]) -> PooledSignals:
    """Signals with the filter they have really been through: a sidecar may not know of the measuring chain's.

    Parameters
    ----------
    pooled : PooledSignals
        Signals of one pantograph.
    who : str
        It is, for messages.
    warnings : list[str]
        Is told if the force had been filtered.
    """
    if not pooled.parts or pooled.filter_applied_Hz is not None or pooled.parts[0].rate * HIGHEST_SHARE_OF_RATE < 50:
        return pooled
    upper, inner = (_leakless_rms(pooled, low, high) for low, high in ((30, 50), (5, 20)))
    # Without content at 5-20 Hz there is nothing to compare with.
    if inner <= 1e-3 * float(pooled.delivered.std()) or upper > FILTERED_RATIO * inner:
        return pooled
    cutoff = pooled.parts[0].low_pass.cutoff_Hz
    warnings.append(
        f"the force of {who} has nothing at 30-50 Hz ({upper:.2g} N, {inner:.3g} N at 5-20 Hz): it is taken as "
        f"filtered at {cutoff:g} Hz by the measuring chain, so that nothing is said of what lies above"
    )
    return replace(pooled, parts=tuple(replace(part, filter_applied_Hz=cutoff) for part in pooled.parts))


def _leakless_rms(pooled: PooledSignals, low: float, high: float) -> float:
    """Rms in a band [N] through a Hann window: where a stretch begins and ends must not look like content."""
    power, weight = 0.0, 0
    for part in pooled.parts:
        segment = min(part.delivered.size, round(2 * part.rate))
        frequency, density = welch(part.delivered, part.rate, nperseg=segment)
        inside = (frequency >= low) & (frequency <= high)
        power += part.delivered.size * float(density[inside].sum() * frequency[1])
        weight += part.delivered.size
    return float(np.sqrt(power / weight))
