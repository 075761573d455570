"""Findings of Vo Van, Balmes and Lorang (2015) in a table: printed value, computed value, and whether they agree."""

from collections.abc import Sequence

from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.grading.verdicts import judge
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import TextTable


def build_findings_table(limits: Sequence[Limit], computed: ValuesByOwner, printed: ValuesByOwner) -> TextTable:
    """Table with one row per limit of a case: finding in words, printed and computed value, reproduced or not.

    Parameters
    ----------
    limits : sequence of Limit
        Limits of the case; their notes are the findings in words.
    computed, printed : ValuesByOwner
        Values by pantograph and name.
    """
    rows = []
    for limit in limits:
        value = find_value(limit, computed)
        verdict = "not evaluated" if value is None else judge(value, limit.lower, limit.upper)
        agreement = {"pass": "reproduced", "fail": "not reproduced"}.get(verdict, verdict)
        unit = QUANTITIES[limit.quantity].unit
        texts = [_format_value(number, unit) for number in (find_value(limit, printed), value)]
        rows.append([limit.note or limit.quantity, *texts, agreement])
    return TextTable(caption="Findings", columns=["Finding", "Printed", "Computed", "Verdict"], rows=rows)


def _format_value(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value:.3g} {unit}".strip()
