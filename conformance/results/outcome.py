"""Systems under test: the reference simulator, a record on disk, a command."""

from dataclasses import dataclass, field

from pantocheck.conformance.records.evaluation import Evaluation, Value
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.results_format import Chart, TextTable


@dataclass(frozen=True)
class Outcome:
    """What a system delivers for a case.

    Parameters
    ----------
    record : of the run; None for a static case, and when the system could not run
    static : quantities of the line at rest, by name
    simulated_s : time that was simulated or measured [s]; None if unknown
    wall_s : time the computation took [s]; None if unknown
    dt_s, element_m : time step [s] and length of an element [m]; None if unknown
    notes : what a reader of the report should know of this run
    warnings : what should make him careful
    skipped : why the system does not run this case; None if it did
    errored : one line on what went wrong; None if nothing did
    findings : quantities of a study, by pantograph (0: the line) and name
    charts, tables : of a study, for the report
    summary : quantities that were delivered as numbers, in place of a record
    refined : the same case with element and time step halved, from which the discretisation error is taken
    """

    record: Record | None = None
    static: dict[str, Value] = field(default_factory=dict)
    simulated_s: float | None = None
    wall_s: float | None = None
    dt_s: float | None = None
    element_m: float | None = None
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    skipped: str | None = None
    errored: str | None = None
    findings: dict[int, dict[str, Value]] = field(default_factory=dict)
    charts: tuple[Chart, ...] = ()
    tables: tuple[TextTable, ...] = ()
    summary: Evaluation | None = None
    refined: "Outcome | None" = None
