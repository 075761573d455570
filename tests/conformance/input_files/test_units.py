"""Units: keys in another unit are converted in the hint, and the longest unit at the end of a key counts."""

import pytest

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.units import STANDARD_GRAVITY, convert_unit, find_key_units, suggest_key


@pytest.mark.parametrize(
    ("key", "value", "known", "hint"),
    [
        ("tension_kN", 20, "tension_N", "tension_N = 20000.0 ?"),
        ("stiffness_N_mm", 2.0, "stiffness_N_m", "Stiffnesses are given in newtons per metre"),
        ("stiffness_N_mm", 2.0, "stiffness_N_m", "stiffness_N_m = 2000.0 ?"),
        ("speed_m_s", 69.4, "speed_km_h", "speed_km_h = 249.84 ?"),
        ("area_cm2", 1.5, "area_mm2", "area_mm2 = 150.0 ?"),
        ("mass", 1.0, "mass_kg", "mass_kg = 1.0 ?"),
    ],
)
def test_key_in_another_unit_is_converted(key: str, value: float, known: str, hint: str) -> None:
    assert hint in (suggest_key(key, value, [known]) or "")


def test_g_is_grams_in_a_key_and_gravity_at_a_sensor() -> None:
    assert find_key_units("kg")["g"] == 1e-3
    assert convert_unit("g", "here") == ("acceleration", STANDARD_GRAVITY)


def test_unknown_unit_is_refused() -> None:
    with pytest.raises(InputError, match="unit 'furlong' is not known"):
        convert_unit("furlong", "here")
