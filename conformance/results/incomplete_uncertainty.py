"""Half-widths that lack a component of the uncertainty: their mark, and its explanation.

A component that is not known is not zero: the half-width of the others is then too small.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from pantocheck.conformance.quantities.uncertainty import UNKNOWN_BASIS

INCOMPLETE_MARK = "*"
"""Mark of a half-width without a component that is not known."""


def list_unknown(basis: Mapping[Any, str]) -> tuple[str, ...]:
    """Components that are not known.

    Args:
        basis: `uncertainty_basis` of a case.
    """
    return tuple(name for name, text in basis.items() if text.startswith(UNKNOWN_BASIS))


def list_missing(basis: Mapping[Any, str], uncertainty: float | None, trust: str | None) -> tuple[str, ...]:
    """Components that the half-width of a criterion lacks.

    A comparison with the converged solution needs the discretisation only: both have the same start and section.

    Args:
        basis: `uncertainty_basis` of the case.
        uncertainty: Half-width of the criterion; None: not known at all.
        trust: Trust of its limits.
    """
    return () if uncertainty is None or trust == "computed" else list_unknown(basis)


def mark_half_width(width: float, text: str, missing: Sequence[str], sign: str = "") -> str:
    """Text of a half-width: marked if a component is missing, and `not known` if the known ones are zero.

    Args:
        width: Half-width.
        text: Its number with significant digits.
        missing: Components that it lacks.
        sign: Sign before the number.
    """
    if not missing:
        return f"{sign}{text}"
    return f"{sign}{text}{INCOMPLETE_MARK}" if width else UNKNOWN_BASIS


def explain_mark(missing: Sequence[str]) -> str:
    """Explanation of the mark, for the components of a case.

    Args:
        missing: Components that are not known; at least one.
    """
    names = " and ".join(filter(None, (", ".join(missing[:-1]), missing[-1])))
    verb = "is" if len(missing) == 1 else "are"
    return f"{INCOMPLETE_MARK} Uncertainty without {names}, which {verb} not known: it is too small."
