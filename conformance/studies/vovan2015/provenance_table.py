"""Line by line: what the study's paper prints, what is assumed, and what is computed."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import TextTable

PAPER = "vovan2015"
"""Key of the study's paper in the bibliography."""
FITTED = "fitted"
"""Begin of the source of a damping model that was fitted to identified modes."""


def build_provenance_table(case: Case) -> TextTable:
    """Where every group of inputs and every limit of a study comes from.

    Parameters
    ----------
    case : Case
        Of a study.
    """
    rows = []
    for given in case.inputs:
        fitted = any(source.startswith(FITTED) for source in given.source)
        whose = "computed" if fitted else _whose(given.trust, given.source)
        rows.append([f"input {given.group}", whose, source_text(given.source)])
    for limit in case.limits:
        item = f" {limit.item}" if limit.item else ""
        text = limit.note or source_text(limit.source)
        keys = [limit.source] if isinstance(limit.source, str) else limit.source
        rows.append([f"limit of {limit.quantity}{item}", _whose(limit.trust, keys), text])
    named = dict.fromkeys(limit.quantity for limit in case.limits)
    rows += [[name, "computed", QUANTITIES[name].definition] for name in named]
    return TextTable(
        caption="What is the paper's, what is assumed, what is computed",
        columns=["What", "Origin", "Source"],
        rows=rows,
    )


def _whose(trust: Trust, keys: Sequence[str]) -> str:
    if trust == "provisional":
        return "assumed"
    return "the paper's" if PAPER in keys else "published elsewhere"
