"""Report of a study of Vo Van, Balmes and Lorang (2015): findings, origin of inputs and limits, and curves."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Series, TextTable
from pantocheck.conformance.core.trust import LimitTrust
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.traces import thin_series

PAPER = "vovan2015"
"""Key of Vo Van, Balmes and Lorang (2015) in the bibliography."""
FITTED = "fitted"
"""Prefix of the source of a damping model that was fitted to identified modes."""


def build_findings_table(limits: Sequence[Limit], computed: ValuesByOwner, printed: ValuesByOwner) -> TextTable:
    """Build a table with one row per limit: finding in words, printed and computed value, agreement.

    The notes of the limits are the findings in words; values are by pantograph and name.
    """
    rows = []
    for limit in limits:
        value, unit = find_value(limit.target, computed), QUANTITIES[limit.quantity].unit
        verdict = "not evaluated" if value is None else judge(value, limit.lower, limit.upper)
        agreement = {"pass": "reproduced", "fail": "not reproduced"}.get(verdict, verdict)
        texts = [
            "-" if number is None else f"{number:.3g} {unit}".strip()
            for number in (find_value(limit.target, printed), value)
        ]
        sentence = limit.finding.sentence if limit.finding else limit.note or limit.quantity
        rows.append([sentence, *texts, agreement])
    return TextTable(caption="Findings", columns=["Finding", "Printed", "Computed", "Agreement"], rows=rows)


def build_provenance_table(case: Case) -> TextTable:
    """Build a table of the origin of every group of inputs, every limit and every graded quantity of a case."""
    rows = []
    for provenance in case.inputs:
        fitted = any(source.startswith(FITTED) for source in provenance.source)
        origin = "computed" if fitted else _name_origin(provenance.trust, provenance.source)
        rows.append([f"input {provenance.group}", origin, source_text(provenance.source)])
    for limit in case.limits:
        item = f" {limit.item}" if limit.item else ""
        keys = [limit.source] if isinstance(limit.source, str) else limit.source
        text = limit.finding.tolerance if limit.finding else limit.note or source_text(limit.source)
        rows.append([f"limit of {limit.quantity}{item}", _name_origin(limit.trust, keys), text])
    quantities = dict.fromkeys(limit.quantity for limit in case.limits)
    rows += [[name, "computed", QUANTITIES[name].definition] for name in quantities]
    return TextTable(caption="Origin of inputs, limits and quantities", columns=["Item", "Origin", "Source"], rows=rows)


def find_crossing(x: RealArray, y: RealArray, level: float) -> float | None:
    """Abscissa at which a curve that begins below a level reaches it, interpolated; None if it never does."""
    i = int(np.argmax(y >= level))
    if y[i] < level:
        return None
    return float(x[i - 1] + (level - y[i - 1]) / (y[i] - y[i - 1]) * (x[i] - x[i - 1]))


def rms(signal: RealArray) -> float:
    """Root mean square of a signal, in its unit."""
    return float(np.sqrt(np.mean(signal**2)))


def draw_curve(label: str, x: RealArray, y: RealArray) -> Series:
    """Draw a line with the points that a figure can show."""
    return Series(label=label, style="line", x=thin_series(x), y=thin_series(y))


def _name_origin(trust: LimitTrust, keys: Sequence[str]) -> str:
    if trust == "provisional":
        return "assumed"
    return "printed in the paper" if PAPER in keys else "published elsewhere"
