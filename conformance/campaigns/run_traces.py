"""Traces of a run: curves of force and uplift, stored compressed beside its row."""

import zlib
from typing import Literal

from pantocheck.conformance.core.figure_data import Traces, UpliftTrace
from pantocheck.conformance.core.results_part import Owner, ResultsPart
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.results_format import CaseResult

StoredTraces = Literal["none", "failing", "all"]
"""Runs whose traces are stored: none, those with the verdict `fail`, or all that have traces."""

_STORED: dict[StoredTraces, frozenset[Verdict] | None] = {
    "none": frozenset(),
    "failing": frozenset({"fail"}),
    "all": None,
}
"""Verdicts of the runs whose traces are stored; None: every verdict."""


class RunTraces(ResultsPart):
    """Curves of a run, as in results.json."""

    traces: dict[Owner, Traces]
    uplift: list[UpliftTrace]


def pack_traces(result: CaseResult, verdict: Verdict | None, stored: StoredTraces) -> bytes:
    """Traces of a run in compressed form; empty if they are not stored for its verdict, or if the run has none."""
    verdicts = _STORED[stored]
    if not result.traces or (verdicts is not None and verdict not in verdicts):
        return b""
    curves = RunTraces(traces=result.traces, uplift=result.uplift)
    return zlib.compress(curves.model_dump_json().encode())


def unpack_traces(content: bytes) -> RunTraces:
    """Traces of a run from their compressed form."""
    return RunTraces.model_validate_json(zlib.decompress(content))
