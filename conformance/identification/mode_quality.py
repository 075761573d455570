"""Quality of an identified mode: phase collinearity and the warnings printed with it."""

import numpy as np

from pantocheck.conformance.array_types import ComplexArray

POINTS_IN_HALF_POWER_BAND = 5
"""Spectral lines that the half-power band should hold (Vo Van, Balmes, Lorang 2015)."""

UNCERTAIN = 0.05
"""Relative standard deviation above which a damping ratio is uncertain."""

LATERAL = 20.0
"""Lateral over vertical amplitude above which an oblique mounting of some degrees explains the vertical signal."""

COINCIDENT = 2.0
"""Half-power bandwidths: the spectrum does not separate two modes that are closer."""


def phase_collinearity(shape: ComplexArray) -> float | None:
    """Modal phase collinearity: 1 for a normal mode, towards 0 for a travelling wave.

    Parameters
    ----------
    shape : (s,) complex ndarray
        Mode shape.

    Returns
    -------
    float or None
        None with fewer than two sensors.

    References
    ----------
    .. [1] J. N. Juang, R. S. Pappa, An eigensystem realization algorithm for modal parameter identification and model
       reduction, J. Guidance 8 (1985) 620-627.
    """
    if shape.size < 2:
        return None
    # Moments about the origin, not about the mean: a shape with equal components is a normal mode.
    xx, yy, xy = (float(np.sum(a * b)) for a, b in ((shape.real,) * 2, (shape.imag,) * 2, (shape.real, shape.imag)))
    total = (xx + yy) ** 2
    return ((xx - yy) ** 2 + 4 * xy**2) / total if total > 0 else None


def is_certain(damping_ratio: float, std: float) -> bool:
    """Whether a damping ratio is known to better than `UNCERTAIN`."""
    return std < UNCERTAIN * damping_ratio


def is_lateral(lateral_share: float | None) -> bool:
    """Whether a mode moves the sensors sideways; parameter as in `list_mode_warnings`."""
    return lateral_share is not None and lateral_share > LATERAL


def list_mode_warnings(
    frequency: float,
    damping_ratio: float,
    damping_ratio_std: float,
    duration: float,
    nearest: float,
    lateral_share: float | None,
) -> tuple[str, ...]:
    """Reasons to doubt a mode.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [Hz].
    damping_ratio, damping_ratio_std : float
        Share of critical damping and its standard deviation [-].
    duration : float
        Length of the linear decay [s].
    nearest : float
        Distance to the nearest other mode [Hz].
    lateral_share : float or None
        Largest lateral over largest vertical amplitude [-]; None without lateral channels.
    """
    warnings = []
    bandwidth = 2 * damping_ratio * frequency
    if bandwidth * duration < POINTS_IN_HALF_POWER_BAND:
        warnings.append(
            f"half-power band: {bandwidth * duration:.1f} spectral lines in {duration:.0f} s; "
            f"{POINTS_IN_HALF_POWER_BAND} need a record of {POINTS_IN_HALF_POWER_BAND / bandwidth:.0f} s"
        )
    if not is_certain(damping_ratio, damping_ratio_std):
        relative = 100 * (damping_ratio_std / damping_ratio)
        warnings.append(f"weakly excited: the damping ratio is uncertain by {relative:.0f} % (one standard deviation)")
    if nearest < COINCIDENT * bandwidth or nearest * duration < 1.5:
        warnings.append(f"near-coincident: another mode is only {1000 * nearest:.1f} mHz away")
    if is_lateral(lateral_share):
        warnings.append(
            "lateral: the mode moves the sensors sideways; their mounting explains the signal of the vertical channels"
        )
    return tuple(warnings)
