"""Units: keys in another unit are converted in the hint, and the longest unit at the end of a key counts."""

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.units import STANDARD_GRAVITY, convert_key, convert_unit, find_key_units, suggest_key


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


@pytest.mark.parametrize(
    ("symbol", "units"),
    [
        ("N", {"N": 1.0, "kN": 1e3, "daN": 10.0}),
        ("m", {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3}),
        ("kg", {"kg": 1.0, "g": 1e-3, "t": 1e3}),
        ("kg_m", {"kg_m": 1.0, "g_m": 1e-3, "kg_km": 1e-3}),
        ("N_m", {"N_m": 1.0, "kN_m": 1e3, "MN_m": 1e6, "N_mm": 1e3, "kN_mm": 1e6}),
        ("m_N", {"m_N": 1.0, "mm_N": 1e-3, "mm_daN": 1e-4, "mm_kN": 1e-6, "m_kN": 1e-3, "cm_kN": 1e-5}),
        ("N_s_m", {"N_s_m": 1.0, "Ns_m": 1.0, "kN_s_m": 1e3, "kNs_m": 1e3}),
        ("N_m2", {"N_m2": 1.0, "Nm2": 1.0, "kN_m2": 1e3, "kNm2": 1e3}),
        ("m2", {"m2": 1.0, "mm2": 1e-6, "cm2": 1e-4}),
        ("m_s", {"m_s": 1.0, "mm_s": 1e-3, "km_h": 1000 / 3600, "mph": 1609.344 / 3600}),
        ("m_s2", {"m_s2": 1.0, "mm_s2": 1e-3, "g": 9.80665, "mg": 9.80665e-3}),
        ("s", {"s": 1.0, "ms": 1e-3}),
        ("Hz", {"Hz": 1.0, "kHz": 1e3}),
    ],
)
def test_every_unit_of_a_key_has_its_defined_factor(symbol: str, units: dict[str, float]) -> None:
    """Definitions of the SI, of the international mile and of the standard gravity; rounding of one division."""
    assert find_key_units(symbol) == pytest.approx(units, rel=1e-14)


@pytest.mark.parametrize(
    ("unit", "other", "factor"), [("km_h", "m_s", 3.6), ("mm2", "cm2", 100.0), ("kN_mm", "N_m", 1e-6), ("g", "t", 1e6)]
)
def test_factor_is_that_to_the_unit_of_the_key(unit: str, other: str, factor: float) -> None:
    """A quotient of two definitions, each rounded once."""
    assert find_key_units(unit)[other] == pytest.approx(factor, rel=1e-14)


@pytest.mark.parametrize(
    ("key", "value", "hint"),
    [
        ("x_mm", [1000.0] * 20, f"x_m = [{', '.join(['1.0'] * 20)}] ?"),
        ("x_mm", [1000.0] * 21, f"x_m = [{', '.join(['1.0'] * 20)}, ...] ?"),
        ("x_mm", [True, "a"], "x_m = [True, 'a'] ?"),
        ("x_mm", True, "did you mean x_m ?"),
        ("x_mm", "1000", "did you mean x_m ?"),
        ("x_mm", float("inf"), "x_m = inf ?"),
        ("x_mm", 1234567.8901234, "x_m = 1234.56789012 ?"),
    ],
)
def test_hint_repeats_numbers_and_short_lists(key: str, value: object, hint: str) -> None:
    """A long list is shown up to its 20th number; a number with twelve digits."""
    assert (suggest_key(key, value, ["y_kg", "x_m"]) or "").endswith(hint)


def test_spellings_and_unknown_units() -> None:
    for text in (" m/s2 ", "m/s^2", "m/s**2", "M/S²", "ms-2", "m s-2"):
        assert convert_unit(text, "here") == ("acceleration", 1.0), text
    for text in ("g", "gn", "g_n"):
        assert convert_unit(text, "here") == ("acceleration", STANDARD_GRAVITY), text
    with pytest.raises(InputError) as caught:
        convert_unit("x" * 100, "here")
    assert caught.value.found == f"has the unknown unit '{'x' * 40}'"
    assert caught.value.hint == "Known units are m/s2, mm/s2, g, mg, m/s, mm/s, km/h, mph, m, mm, cm, km."
    assert suggest_key("x_ft", 1.0, ["x_m", "name"]) is None
    for name in ("span", "span_N", "length_m", "number_m", "stiffness_m", ""):
        assert convert_key(name, ["number", "span_m", "stiffness_N_m"]) is None, name


@pytest.mark.parametrize(
    ("name", "key", "factor"),
    [
        ("span_m", "span_m", 1.0),
        ("span_km", "span_m", 1000.0),
        ("stagger_mm", "stagger_m", 1e-3),
        ("stiffness_kN_mm", "stiffness_N_m", 1e6),
        ("elasticity_mm_kN", "elasticity_m_N", 1e-6),
    ],
)
def test_name_in_another_unit_is_a_key_with_a_factor(name: str, key: str, factor: float) -> None:
    """Definitions of the SI, rounded once."""
    converted = convert_key(name, ["number", "span_m", "stagger_m", "stiffness_N_m", "elasticity_m_N"])
    assert converted == (key, pytest.approx(factor, rel=1e-14))
