"""A mode as it is reported, and what there is to say about it."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.mass_drops.drop_record import DropChannel

POINTS_IN_HALF_POWER_BAND = 5  # the study's rule
UNCERTAIN = 0.05  # relative standard deviation of a damping ratio above which it says little
LATERAL = 20.0  # lateral over vertical amplitude beyond which a few degrees of mounting explain the vertical one
COINCIDENT = 2.0  # modes nearer than this many half-power bandwidths are told apart by the model alone


@dataclass(frozen=True)
class Mode:
    """One identified mode.

    Parameters
    ----------
    frequency : float
        |lambda| / 2 pi [Hz].
    frequency_std : float
        Its standard deviation [Hz].
    damping_ratio : float
        Share of critical damping.
    damping_ratio_std : float
        Its standard deviation.
    channels : tuple[DropChannel, ...]
        (s,) of the record that shows the mode best.
    shape : (s,) complex ndarray
        ComplexArray shape at them, the largest 1.
    shape_std : (s,) ndarray
        Standard deviation of its real and of its imaginary part.
    amplitude : float
        Largest amplitude of any sensor at the release [unit of the record].
    collinearity : float or None
        Modal phase collinearity, 1 for a normal mode; None with a single sensor.
    error : float
        What the fit leaves in the mode's band, over what is measured there.
    record : str
        Name of the record that shows the mode best.
    group : int or None
        Number of its group of span modes, None if it fits none.
    outlier : bool
        Its damping ratio is far from its group's.
    lateral_share : float or None
        Largest lateral over largest vertical amplitude; None without lateral channels.
    half_power_points : float
        Spectral lines inside the half-power band.
    warnings : tuple[str, ...]
        Why it should not be believed without more.
    """

    frequency: float
    frequency_std: float
    damping_ratio: float
    damping_ratio_std: float
    channels: tuple[DropChannel, ...]
    shape: ComplexArray
    shape_std: RealArray
    amplitude: float
    collinearity: float | None
    error: float
    record: str
    group: int | None = None
    outlier: bool = False
    lateral_share: float | None = None
    half_power_points: float = 0.0
    warnings: tuple[str, ...] = ()

    @property
    def certain(self) -> bool:
        """Whether its damping ratio is known to better than `UNCERTAIN`."""
        return self.damping_ratio_std < UNCERTAIN * self.damping_ratio

    @property
    def lateral(self) -> bool:
        """Whether it moves the sensors sideways and reaches the vertical channels by their mounting alone."""
        return self.lateral_share is not None and self.lateral_share > LATERAL


def phase_collinearity(shape: ComplexArray) -> float | None:
    """Modal phase collinearity: 1 if all components move in phase or against it, towards 0 for a travelling wave.

    Parameters
    ----------
    shape : (s,) complex ndarray
        ComplexArray shape.

    References
    ----------
    .. [1] J. N. Juang, R. S. Pappa, An eigensystem realization algorithm for modal parameter identification and model
       reduction, J. Guidance 8 (1985) 620-627.
    """
    if shape.size < 2:
        return None
    # Turned about the origin, not about the mean: a shape with all sensors alike is a normal mode.
    xx, yy, xy = (float(np.sum(a * b)) for a, b in ((shape.real,) * 2, (shape.imag,) * 2, (shape.real, shape.imag)))
    total = (xx + yy) ** 2
    return ((xx - yy) ** 2 + 4 * xy**2) / total if total > 0 else None


def normalise_shape(residues: ComplexArray) -> ComplexArray:
    """Shape of residues with its largest component 1."""
    largest = residues[np.argmax(np.abs(residues))]
    return np.asarray(residues / largest) if np.abs(largest) > 0 else residues


def mode_remarks(
    frequency: float,
    damping_ratio: float,
    damping_ratio_std: float,
    duration: float,
    nearest: float,
    lateral_share: float | None,
) -> tuple[str, ...]:
    """Warnings of one mode.

    Parameters
    ----------
    frequency : float
        [Hz].
    damping_ratio, damping_ratio_std : float
        And its standard deviation.
    duration : float
        Of the stretch used [s].
    nearest : float
        Distance to the nearest other mode [Hz].
    lateral_share : float or None
        Largest lateral over largest vertical amplitude.
    """
    found = []
    bandwidth = 2 * damping_ratio * frequency
    if bandwidth * duration < POINTS_IN_HALF_POWER_BAND:
        needed = POINTS_IN_HALF_POWER_BAND / bandwidth
        found.append(
            f"half-power band: {bandwidth * duration:.1f} spectral lines in {duration:.0f} s; "
            f"{POINTS_IN_HALF_POWER_BAND} would need a record of {needed:.0f} s"
        )
    relative = damping_ratio_std / damping_ratio
    if relative > UNCERTAIN:
        found.append(
            f"weakly excited: the damping ratio is uncertain by {100 * relative:.0f} % (one standard deviation)"
        )
    if nearest < COINCIDENT * bandwidth or nearest * duration < 1.5:
        found.append(f"near-coincident: another mode is only {1000 * nearest:.1f} mHz away")
    if lateral_share is not None and lateral_share > LATERAL:
        found.append(
            "lateral: moves the sensors sideways; what the vertical channels show of it, their mounting explains"
        )
    return tuple(found)
