"""Origin of every input and limit of a case: printed by Vo Van, Balmes and Lorang (2015), assumed, or computed."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import TextTable

PAPER = "vovan2015"
"""Key of Vo Van, Balmes and Lorang (2015) in the bibliography."""
FITTED = "fitted"
"""Prefix of the source of a damping model that was fitted to identified modes."""


def build_provenance_table(case: Case) -> TextTable:
    """Table of the origin of every group of inputs and every limit of a case."""
    rows = []
    for provenance in case.inputs:
        fitted = any(source.startswith(FITTED) for source in provenance.source)
        origin = "computed" if fitted else _origin(provenance.trust, provenance.source)
        rows.append([f"input {provenance.group}", origin, source_text(provenance.source)])
    for limit in case.limits:
        item = f" {limit.item}" if limit.item else ""
        text = limit.note or source_text(limit.source)
        keys = [limit.source] if isinstance(limit.source, str) else limit.source
        rows.append([f"limit of {limit.quantity}{item}", _origin(limit.trust, keys), text])
    quantities = dict.fromkeys(limit.quantity for limit in case.limits)
    rows += [[name, "computed", QUANTITIES[name].definition] for name in quantities]
    return TextTable(
        caption="What is the paper's, what is assumed, what is computed",
        columns=["What", "Origin", "Source"],
        rows=rows,
    )


def _origin(trust: Trust, keys: Sequence[str]) -> str:
    if trust == "provisional":
        return "assumed"
    return "the paper's" if PAPER in keys else "published elsewhere"
