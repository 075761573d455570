"""Words of a half-width of zero, and values above the supported frequency."""

import pytest

from pantocheck.conformance.quantities.uncertainty import UNKNOWN_BASIS
from pantocheck.conformance.results.incomplete_uncertainty import EXACT_WIDTH, describe_half_width
from pantocheck.conformance.results.supported_frequency import SupportedFrequency, is_supported


@pytest.mark.parametrize(
    ("width", "missing", "quantity", "words"),
    [
        (0.2, ("start",), "std_force_N", "number"),
        (0.0, (), "std_force_N", "number"),
        (0.0, ("start",), "std_force_N", UNKNOWN_BASIS),
        (0.0, ("start",), "wave_speed_m_s", EXACT_WIDTH),
        (0.0, ("start",), "quantity of a later version", UNKNOWN_BASIS),
    ],
)
def test_half_width_of_zero_is_exact_for_a_line_at_rest_alone(
    width: float, missing: tuple[str, ...], quantity: str, words: str
) -> None:
    assert describe_half_width(width, "number", missing, quantity) == words


def test_band_above_the_frequency_of_its_pantograph_is_not_supported() -> None:
    """20-50 Hz on elements for 60 Hz: pantograph 1 supports 20 Hz, of pantograph 2 nothing is known."""
    known = {"pantograph 1": 20.0, "pantograph 2": None, "elements": 60.0}
    parts = [SupportedFrequency(part=part, frequency_Hz=value, basis="test") for part, value in known.items()]
    assert [is_supported(parts, owner, "rms_20_50_N") for owner in ("0", "1", "2")] == [False, False, True]
    assert is_supported(parts, "1", "rms_5_20_N")
    assert is_supported(parts, "1", "quantity of a later version")
