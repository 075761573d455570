"""Spectral lines in the half-power band of the modes, a rule for methods that read this band from a spectrum.

A mode with damping ratio z and frequency f has 2 z f T lines in a linear decay of the duration T.
"""

from pantocheck.conformance.identification.identification_format import HalfPowerLines
from pantocheck.conformance.identification.mode import Mode

RECOMMENDED_LINES = 5
"""Recommended number of spectral lines in the half-power band (Vo Van, Balmes, Lorang 2015)."""


def count_half_power_lines(modes: tuple[Mode, ...]) -> HalfPowerLines:
    """Count the modes with fewer lines than recommended; the needed duration is that of the certain vertical modes."""
    lines = [mode.half_power_points for mode in modes if mode.half_power_points is not None]
    bandwidths = [2 * mode.damping_ratio * mode.frequency_Hz for mode in modes if mode.certain and not mode.lateral]
    return HalfPowerLines(
        recommended=RECOMMENDED_LINES,
        modes=len(lines),
        fewer=sum(number < RECOMMENDED_LINES for number in lines),
        needed_s=RECOMMENDED_LINES / min(bandwidths) if bandwidths else None,
    )
