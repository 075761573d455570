"""Units at the end of keys: what a key in another unit would be in the unit of the schema."""

import math

KEY_UNITS: dict[str, tuple[str, float]] = {
    "N": ("Forces are given in newtons", 1.0),
    "kN": ("Forces are given in newtons", 1e3),
    "daN": ("Forces are given in newtons", 10.0),
    "m": ("Lengths are given in metres", 1.0),
    "mm": ("Lengths are given in metres", 1e-3),
    "cm": ("Lengths are given in metres", 1e-2),
    "km": ("Lengths are given in metres", 1e3),
    "kg": ("Masses are given in kilograms", 1.0),
    "g": ("Masses are given in kilograms", 1e-3),
    "t": ("Masses are given in kilograms", 1e3),
    "kg_m": ("Masses per length are given in kilograms per metre", 1.0),
    "g_m": ("Masses per length are given in kilograms per metre", 1e-3),
    "kg_km": ("Masses per length are given in kilograms per metre", 1e-3),
    "N_m": ("Stiffnesses are given in newtons per metre", 1.0),
    "kN_m": ("Stiffnesses are given in newtons per metre", 1e3),
    "MN_m": ("Stiffnesses are given in newtons per metre", 1e6),
    "N_mm": ("Stiffnesses are given in newtons per metre", 1e3),
    "kN_mm": ("Stiffnesses are given in newtons per metre", 1e6),
    "N_s_m": ("Dampers are given in newton seconds per metre", 1.0),
    "Ns_m": ("Dampers are given in newton seconds per metre", 1.0),
    "kN_s_m": ("Dampers are given in newton seconds per metre", 1e3),
    "kNs_m": ("Dampers are given in newton seconds per metre", 1e3),
    "N_m2": ("Bending stiffnesses are given in newton square metres", 1.0),
    "Nm2": ("Bending stiffnesses are given in newton square metres", 1.0),
    "kN_m2": ("Bending stiffnesses are given in newton square metres", 1e3),
    "kNm2": ("Bending stiffnesses are given in newton square metres", 1e3),
    "mm2": ("Cross-sections are given in square millimetres", 1.0),
    "cm2": ("Cross-sections are given in square millimetres", 100.0),
    "m2": ("Cross-sections are given in square millimetres", 1e6),
    "km_h": ("Speeds are given in kilometres per hour", 1.0),
    "m_s": ("Speeds are given in kilometres per hour", 3.6),
    "mph": ("Speeds are given in kilometres per hour", 1.609344),
    "s": ("Times are given in seconds", 1.0),
    "ms": ("Times are given in seconds", 1e-3),
    "Hz": ("Frequencies are given in hertz", 1.0),
    "kHz": ("Frequencies are given in hertz", 1e3),
}
"""Unit at the end of a key: what is said of its kind, and its factor to the unit of the schema."""


def convert_key(key: str, value: object, known: list[str]) -> str | None:
    """Hint for a key in a unit that the schema does not use, its value converted; None if it is not that."""
    for other in known:
        found = _same_in_another_unit(key, other)
        if found is None:
            continue
        saying, factor = found
        if isinstance(value, bool) or not isinstance(value, int | float | list):
            return f"{saying}: did you mean {other} ?"
        return f"{saying}: did you mean {other} = {_scaled(value, factor)} ?"
    return None


def _same_in_another_unit(key: str, other: str) -> tuple[str, float] | None:
    for unit, (saying, factor) in KEY_UNITS.items():
        if not key.endswith(f"_{unit}"):
            continue
        stem = key.removesuffix(f"_{unit}")
        for wanted, (same_saying, wanted_factor) in KEY_UNITS.items():
            if other == f"{stem}_{wanted}" and saying == same_saying:
                return saying, factor / wanted_factor
    # A key without its unit.
    for unit, (saying, _) in KEY_UNITS.items():
        if other == f"{key}_{unit}":
            return saying, 1.0
    return None


def _scaled(value: object, factor: float) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_scaled(item, factor) for item in value[:20])}{', ...' if len(value) > 20 else ''}]"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return repr(value)
    scaled = float(value) * factor
    return repr(float(f"{scaled:.12g}")) if math.isfinite(scaled) else str(scaled)
