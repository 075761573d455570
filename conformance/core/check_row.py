"""Row of a consistency check of a record: its deciding number, its thresholds, and the outcome that follows."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart

RowOutcome = Literal["confirmed", "unchecked", "doubt", "contradiction", "not reached"]

Misgiving = Literal["contradiction", "doubt", "unchecked"]
"""Outcome beyond a threshold."""

MISGIVINGS: tuple[Misgiving, ...] = ("contradiction", "doubt", "unchecked")
"""Outcomes beyond a threshold, the worst first."""

Cause = Literal["holds", "does not apply", "named by another check", "does not hold", "not possible", "not reached"]

_OUTCOMES: dict[Cause, RowOutcome] = {
    "holds": "confirmed",
    "does not apply": "confirmed",
    "named by another check": "confirmed",
    "does not hold": "contradiction",
    "not possible": "unchecked",
    "not reached": "not reached",
}


class Measured(ResultsPart):
    """Number that decides a check; of several parts or numbers, the one that is nearest to its threshold or beyond."""

    kind: Literal["measured"] = "measured"
    measure: str
    """Name of the number."""
    number: FiniteNumber
    unit: str
    """Unit; empty for a ratio."""
    side: Literal["above", "below"]
    """Side of the thresholds on which the condition does not hold."""
    thresholds: dict[Misgiving, FiniteNumber]
    """Thresholds by the outcome beyond them."""
    part: str = ""
    """Pantograph or support; empty for the whole record."""

    @property
    def outcome(self) -> RowOutcome:
        """Worst outcome whose threshold the number exceeds, or stays below."""
        for outcome in MISGIVINGS:
            limit = self.thresholds.get(outcome)
            if limit is not None and (self.number > limit if self.side == "above" else self.number < limit):
                return outcome
        return "confirmed"

    @property
    def utilisation(self) -> float:
        """Number over its nearest threshold, or the threshold over the number; 1 at the threshold."""
        if self.side == "above":
            return self.number / min(self.thresholds.values())
        return max(self.thresholds.values()) / self.number if self.number > 0 else float("inf")


class NotMeasured(ResultsPart):
    """Cause of the outcome of a check without a number."""

    kind: Literal["not measured"] = "not measured"
    cause: Cause
    """`named by another check`: a channel is missing that another check needs as well."""

    @property
    def outcome(self) -> RowOutcome:
        """Outcome that follows from the cause."""
        return _OUTCOMES[self.cause]


RowBasis = Measured | NotMeasured


class CheckRow(ResultsPart):
    """Outcome of a consistency check of a record."""

    check: str
    outcome: RowOutcome
    """`confirmed` if the check holds or does not apply; `not reached` behind a contradiction."""
    text: str = ""
    """Text of the finding; empty if the check has none."""
    basis: Annotated[RowBasis, Field(discriminator="kind")]
    """Number with its thresholds, or the cause, from which the outcome follows."""
