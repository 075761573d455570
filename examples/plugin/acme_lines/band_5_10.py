"""RMS of the contact force in 5-10 Hz."""

import numpy as np

from pantocheck.conformance.extension import ForceQuantity, ForceSignals, Sampling


def band_rms(signals: ForceSignals, sampling: Sampling) -> np.ndarray:
    """Standard deviation of the part of the force in ]5, 10] Hz [N]."""
    return sampling.std(signals.band_part(5.0, 10.0))


quantity = ForceQuantity(
    unit="N",
    definition="RMS of the contact force in the band ]5, 10] Hz",
    needs="force_20",
    compute=band_rms,
)
