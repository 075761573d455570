"""Units at the end of keys, and units of measured channels, in one table."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.core.input_error import InputError

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2]."""

MotionQuantity = Literal["acceleration", "velocity", "displacement"]


@dataclass(frozen=True)
class UnitFamily:
    """Units of one physical quantity."""

    rule: str
    """Sentence that states the unit of the schema, for messages."""
    factors: dict[str, float]
    """Factor to the SI unit by symbol."""


_LENGTH = UnitFamily("Lengths are given in metres", {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3})
_SPEED = UnitFamily(
    "Speeds are given in kilometres per hour",
    {"m/s": 1.0, "mm/s": 1e-3, "km/h": 1 / 3.6, "mph": 1.609344 / 3.6},
)
_ACCELERATION = UnitFamily(
    "Accelerations are given in metres per second squared",
    {"m/s2": 1.0, "mm/s2": 1e-3, "g": STANDARD_GRAVITY, "mg": 1e-3 * STANDARD_GRAVITY},
)

UNIT_FAMILIES = (
    UnitFamily("Forces are given in newtons", {"N": 1.0, "kN": 1e3, "daN": 10.0}),
    _LENGTH,
    UnitFamily("Masses are given in kilograms", {"kg": 1.0, "g": 1e-3, "t": 1e3}),
    UnitFamily(
        "Masses per length are given in kilograms per metre",
        {"kg/m": 1.0, "g/m": 1e-3, "kg/km": 1e-3},
    ),
    UnitFamily(
        "Stiffnesses are given in newtons per metre",
        {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "N/mm": 1e3, "kN/mm": 1e6},
    ),
    UnitFamily(
        "Elasticities are given in millimetres per newton",
        {"m/N": 1.0, "mm/N": 1e-3, "mm/daN": 1e-4, "mm/kN": 1e-6, "m/kN": 1e-3, "cm/kN": 1e-5},
    ),
    UnitFamily(
        "Dampers are given in newton seconds per metre",
        {"N s/m": 1.0, "Ns/m": 1.0, "kN s/m": 1e3, "kNs/m": 1e3},
    ),
    UnitFamily(
        "Bending stiffnesses are given in newton square metres",
        {"N m2": 1.0, "Nm2": 1.0, "kN m2": 1e3, "kNm2": 1e3},
    ),
    UnitFamily("Cross-sections are given in square millimetres", {"mm2": 1e-6, "cm2": 1e-4, "m2": 1.0}),
    _SPEED,
    _ACCELERATION,
    UnitFamily("Times are given in seconds", {"s": 1.0, "ms": 1e-3}),
    UnitFamily("Frequencies are given in hertz", {"Hz": 1.0, "kHz": 1e3}),
    UnitFamily("Currents are given in amperes", {"A": 1.0, "kA": 1e3, "mA": 1e-3}),
    UnitFamily("Mobilities are given in metres per second per newton", {"m/s/N": 1.0, "mm/s/N": 1e-3, "m/s/kN": 1e-3}),
    UnitFamily(
        "Accelerances are given in metres per second squared per newton",
        {"m/s2/N": 1.0, "mm/s2/N": 1e-3, "g/N": STANDARD_GRAVITY},
    ),
    UnitFamily("Phases are given in degrees", {"deg": 1.0, "rad": math.degrees(1.0)}),
)

MOTION_UNITS: dict[MotionQuantity, dict[str, float]] = {
    "acceleration": _ACCELERATION.factors,
    "velocity": _SPEED.factors,
    "displacement": _LENGTH.factors,
}
"""Units of motion sensors, with their factors to the SI unit."""

SI_UNITS: dict[MotionQuantity, str] = {"acceleration": "m/s2", "velocity": "m/s", "displacement": "m"}

SPELLINGS = {"m/s^2": "m/s2", "m/s**2": "m/s2", "m/s²": "m/s2", "ms-2": "m/s2", "m s-2": "m/s2", "gn": "g", "g_n": "g"}


def key_suffix(symbol: str) -> str:
    """Unit at the end of a key: `N_s_m` for `N s/m`."""
    return symbol.replace(" ", "_").replace("/", "_")


_FAMILY_BY_SUFFIX = sorted(
    ((key_suffix(symbol), family) for family in UNIT_FAMILIES for symbol in family.factors),
    key=lambda item: -len(item[0]),
)
"""Unit families by suffix, the longest suffix first: `stiffness_N_m` is a stiffness, not a length."""


def find_key_units(suffix: str) -> dict[str, float]:
    """Suffixes of all units of one quantity, with their factors to the unit of `suffix`."""
    family = next(family for known, family in _FAMILY_BY_SUFFIX if known == suffix)
    factors = {key_suffix(symbol): factor for symbol, factor in family.factors.items()}
    return {known: factor / factors[suffix] for known, factor in factors.items()}


def find_unit(key: str) -> str | None:
    """Unit at the end of a key, as in `key_suffix`; None if the key has no unit."""
    return next((suffix for suffix, _ in _FAMILY_BY_SUFFIX if key.endswith(f"_{suffix}")), None)


def convert_key(name: str, known: Sequence[str]) -> tuple[str, float] | None:
    """Find the key of a schema that a name has in the same or in another unit.

    Args:
        name: Name with its unit, such as `span_km`.
        known: Keys of the schema, such as `span_m`.

    Returns:
        Key, and the factor from the unit of the name to that of the key; None if no key differs in its unit only.
    """
    if name in known:
        return name, 1.0
    for key in known:
        if (unit := find_unit(key)) is None:
            continue
        stem = key.removesuffix(unit)
        factor = find_key_units(unit).get(name.removeprefix(stem))
        if name.startswith(stem) and factor is not None:
            return key, factor
    return None


def suggest_key(key: str, value: object, known: list[str]) -> str | None:
    """Hint for an unknown key that is a key of the schema in another unit.

    Args:
        key: Unknown key.
        value: Its value; the hint repeats it in the unit of the schema.
        known: Keys of the schema.

    Returns:
        Sentence with the key of the schema; None if no key of the schema differs in its unit only.
    """
    for other in known:
        for suffix, family in _FAMILY_BY_SUFFIX:
            if not other.endswith(f"_{suffix}"):
                continue
            stem = other.removesuffix(f"_{suffix}")
            factors = {f"{stem}_{unit}": factor for unit, factor in find_key_units(suffix).items()} | {stem: 1.0}
            if key not in factors:
                continue
            if isinstance(value, bool) or not isinstance(value, int | float | list):
                return f"{family.rule}: did you mean {other} ?"
            return f"{family.rule}: did you mean {other} = {_scaled(value, factors[key])} ?"
    return None


def _scaled(value: object, factor: float) -> str:
    """Value times a factor, as TOML."""
    if isinstance(value, list):
        return f"[{', '.join(_scaled(item, factor) for item in value[:20])}{', ...' if len(value) > 20 else ''}]"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return repr(value)
    scaled = float(value) * factor
    return repr(float(f"{scaled:.12g}")) if math.isfinite(scaled) else str(scaled)


def convert_unit(text: str, where: str) -> tuple[MotionQuantity, float]:
    """Quantity of a unit of motion, and the factor to its SI unit; `where` is the place of the unit in messages.

    Raises:
        InputError: The unit is not known; a guessed unit would scale every amplitude.
    """
    name = text.strip()
    name = SPELLINGS.get(name.lower(), name)
    for quantity, factors in MOTION_UNITS.items():
        if name in factors:
            return quantity, factors[name]
    known = ", ".join(unit for factors in MOTION_UNITS.values() for unit in factors)
    raise InputError(where, f"has the unknown unit {text[:40]!r}", f"Known units are {known}.")


def is_unit(text: str) -> bool:
    """Whether a text is a unit of any quantity, in brackets or not; empty text and a dash mean no unit."""
    name = text.strip().strip("[]()").strip()
    return name in _UNIT_NAMES or SPELLINGS.get(name.lower()) is not None


_UNIT_NAMES = {
    *("", "-", "1", "%", "V", "mV", "kV", "A", "mA", "kA", "°", "deg", "rad", "°C", "K", "bar", "kPa", "min", "h"),
    *(symbol for family in UNIT_FAMILIES for symbol in family.factors),
}
"""Units of a line of units, also of quantities that are not read."""
