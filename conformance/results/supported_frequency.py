"""Highest frequency that the models of a case support, and the rule by which pages grey values above it."""

from collections.abc import Sequence

from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart
from pantocheck.conformance.quantities.registry import QUANTITIES

UNKNOWN_FREQUENCY = "not known"
"""Highest supported frequency of a part without measured responses or source."""


class SupportedFrequency(ResultsPart):
    """Highest frequency that one part of a model supports."""

    part: str
    """Part of the model, e.g. pantograph 1 or elements."""
    frequency_Hz: FiniteNumber | None
    """Highest supported frequency [Hz]; null: not known."""
    basis: str
    """Origin or formula of the frequency."""
    limits: bool = True
    """Whether values above the frequency are not supported; false: a fact about the line alone."""


def name_pantograph_part(number: int | str) -> str:
    """Part of a pantograph by its number."""
    return f"pantograph {number}"


def find_supported_Hz(parts: Sequence[SupportedFrequency], owner: str) -> float | None:
    """Highest frequency up to which the values of an owner are supported [Hz]; None: not known, nothing is greyed.

    It is the lowest known frequency of the parts that act on them: the line, and the pantograph itself; on values of
    the line ("0"), all pantographs. A part whose frequency is not known limits nothing.
    """
    own = name_pantograph_part(owner)
    known = [
        part.frequency_Hz
        for part in parts
        if part.limits
        and part.frequency_Hz is not None
        and (owner == "0" or part.part == own or not part.part.startswith("pantograph "))
    ]
    return min(known, default=None)


def is_supported(parts: Sequence[SupportedFrequency], owner: str, quantity: str) -> bool:
    """Whether a quantity has no content above the supported frequency of its owner, or that is not known."""
    highest = QUANTITIES[quantity].highest_Hz if quantity in QUANTITIES else None
    return highest is None or reaches(parts, owner, highest)


def reaches(parts: Sequence[SupportedFrequency], owner: str, frequency_Hz: float) -> bool:
    """Whether the supported frequency of an owner is at least a frequency [Hz], or not known."""
    supported = find_supported_Hz(parts, owner)
    return supported is None or frequency_Hz <= supported


def describe_supported(parts: Sequence[SupportedFrequency], owner: str) -> str:
    """Highest supported frequency of an owner in words; not known if one of its pantographs has none."""
    names = [part for part in parts if part.part.startswith("pantograph ")]
    own = names if owner == "0" else [part for part in names if part.part == name_pantograph_part(owner)]
    supported = find_supported_Hz(parts, owner)
    if supported is None or any(part.frequency_Hz is None for part in own):
        return UNKNOWN_FREQUENCY
    return f"{supported:.3g} Hz"
