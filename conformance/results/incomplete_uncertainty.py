"""Half-widths of an uncertainty in words, and the components that they lack.

A component that is not known is not zero: the half-width of the others is then too small.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.uncertainty import UNKNOWN_BASIS

EXACT_WIDTH = "exact"
"""Half-width of a value of the line at rest that does not change with the mesh: it has a closed form."""


def list_unknown(basis: Mapping[Any, str]) -> tuple[str, ...]:
    """Components that are not known, by the `uncertainty_basis` of a case."""
    return tuple(name for name, text in basis.items() if text.startswith(UNKNOWN_BASIS))


def list_missing(basis: Mapping[Any, str], uncertainty: float | None, trust: str | None) -> tuple[str, ...]:
    """Components that the half-width of a criterion lacks, by the basis of its case and the trust of its limits.

    A comparison with the converged solution needs the discretisation only: both have the same start and section.
    """
    unknown = () if uncertainty is None else list_unknown(basis)
    return tuple(name for name in unknown if name == "discretisation") if trust == "computed" else unknown


def describe_half_width(width: float, number: str, missing: Sequence[str], quantity: str) -> str:
    """The number of a half-width; one of zero is exact for a closed form, and not known if a component is missing."""
    if width:
        return number
    if quantity in QUANTITIES and QUANTITIES[quantity].scope == "static":
        return EXACT_WIDTH
    return UNKNOWN_BASIS if missing else number


def explain_missing(missing: Sequence[str]) -> str:
    """Sentence on the uncertainties of a case that lack components; empty if they lack none."""
    names = " and ".join(filter(None, (", ".join(missing[:-1]), *missing[-1:])))
    verb = "is" if len(missing) == 1 else "are"
    return (
        f"Uncertainties of the passage without {names}, which {verb} not known: they are too small." if missing else ""
    )
