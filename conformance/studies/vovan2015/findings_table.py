"""Findings of a publication in a table: what it says, what was computed, and whether they agree."""

from collections.abc import Sequence

from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.grading.verdicts import judge
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import TextTable


def build_findings_table(limits: Sequence[Limit], computed: ValuesByOwner, printed: ValuesByOwner) -> TextTable:
    """One row per limit of a case: the finding in words, printed and computed value, reproduced or not.

    Parameters
    ----------
    limits : Sequence[Limit]
        Of the case; their notes are the findings in words.
    computed, printed : ValuesByOwner
        By pantograph and name.
    """
    rows = []
    for limit in limits:
        value = find_value(limit, computed)
        verdict = "not evaluated" if value is None else judge(value, limit.lower, limit.upper)
        said = {"pass": "reproduced", "fail": "not reproduced"}.get(verdict, verdict)
        unit = QUANTITIES[limit.quantity].unit
        rows.append([limit.note or limit.quantity, _text(find_value(limit, printed), unit), _text(value, unit), said])
    return TextTable(caption="Findings", columns=["Finding", "Printed", "Computed", "Verdict"], rows=rows)


def _text(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value:.3g} {unit}".strip()
