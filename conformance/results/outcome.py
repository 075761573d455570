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
    record : Record or None
        Of the run; None for a static case, and when the system could not run.
    static : dict[str, Value]
        Quantities of the line at rest, by name.
    simulated_s : float or None
        Time that was simulated or measured [s]; None if unknown.
    wall_s : float or None
        Time the computation took [s]; None if unknown.
    dt_s, element_m : float or None
        Time step [s] and length of an element [m]; None if unknown.
    notes : tuple[str, ...]
        What a reader of the report should know of this run.
    warnings : tuple[str, ...]
        What should make him careful.
    skipped : str or None
        Why the system does not run this case; None if it did.
    errored : str or None
        One line on what went wrong; None if nothing did.
    findings : dict[int, dict[str, Value]]
        Quantities of a study, by pantograph (0: the line) and name.
    charts, tables : tuple[Chart, ...] or tuple[TextTable, ...]
        Of a study, for the report.
    summary : Evaluation or None
        Quantities that were delivered as numbers, in place of a record.
    refined : Outcome or None
        The same case with element and time step halved, from which the discretisation error is taken.
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
