"""Units and directions of channels."""

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import Axis, MotionQuantity

STANDARD_GRAVITY = 9.80665  # [m/s2]

CHANNEL_UNITS: dict[str, tuple[MotionQuantity, float]] = {
    "m/s2": ("acceleration", 1.0),
    "mm/s2": ("acceleration", 1e-3),
    "g": ("acceleration", STANDARD_GRAVITY),
    "mg": ("acceleration", 1e-3 * STANDARD_GRAVITY),
    "m/s": ("velocity", 1.0),
    "mm/s": ("velocity", 1e-3),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
}
"""Unit: what it measures, and its factor to SI."""

SPELLINGS = {"m/s^2": "m/s2", "m/s**2": "m/s2", "m/s²": "m/s2", "ms-2": "m/s2", "m s-2": "m/s2", "gn": "g", "g_n": "g"}


def convert_unit(text: str, where: str) -> tuple[MotionQuantity, float]:
    """What a unit measures and its factor to SI.

    Raises
    ------
    InputError
        The unit is not known; a guess would scale every amplitude.
    """
    name = text.strip()
    name = SPELLINGS.get(name.lower(), name)
    if name not in CHANNEL_UNITS:
        raise InputError(where, f"unit {text[:40]!r} is not known", f"Known units are {', '.join(CHANNEL_UNITS)}.")
    return CHANNEL_UNITS[name]


def parse_direction(text: str, where: str) -> tuple[Axis, float]:
    """Axis and sign of a direction such as `+z` or `-x`.

    Raises
    ------
    InputError
        It is none of +x, -x, +y, -y, +z, -z.
    """
    name = text.strip().lower()
    sign = -1.0 if name.startswith("-") else 1.0
    match name.lstrip("+-"):
        case "x":
            return "x", sign
        case "y":
            return "y", sign
        case "z":
            return "z", sign
    raise InputError(where, f"direction {text[:40]!r} is not known", "Write +x, -x, +y, -y, +z or -z; z is upward.")
