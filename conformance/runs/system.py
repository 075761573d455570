"""System under test: interface of every simulator and record folder."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol

from pantocheck.conformance.cases.case import Case, find_missing_features
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, LineShape, TextTable
from pantocheck.conformance.quantities.evaluation import Evaluation, Value
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import RunTable, StartTable
from pantocheck.conformance.results.case_facts_format import FmuRun
from pantocheck.conformance.results.motion_format import PassageMotion
from pantocheck.conformance.results.supported_frequency import SupportedFrequency


# Outcome of a case on a system: a delivery, a skip with its reason, or an error with its reason.
@dataclass(frozen=True)
class StudyResult:
    """Result of a study that compares several runs."""

    findings: dict[int, dict[str, Value]] = field(default_factory=dict)
    """Quantities by pantograph (0: the line) and name."""
    spread: dict[int, dict[str, float]] = field(default_factory=dict)
    """Largest change of these quantities when the analysis section is shifted."""
    charts: tuple[Chart, ...] = ()
    """Figures for the report."""
    tables: tuple[TextTable, ...] = ()
    """Tables for the report."""


@dataclass(frozen=True)
class Delivered:
    """Data that a system delivered for a case."""

    record: Record | None = None
    """Record of the passage; None for a static case, a mass drop or a summary."""
    static: dict[str, Value] = field(default_factory=dict)
    """Quantities of the line at rest, by name."""
    run: RunTable = field(default_factory=RunTable)
    """Simulated time, computing time, time step and element length, as far as they are known."""
    notes: tuple[str, ...] = ()
    """Remarks on the run for the reader of the report."""
    warnings: tuple[str, ...] = ()
    """Caveats for the reader of the report."""
    model_uncertainty: tuple[str, ...] = ()
    """Effects that the equations of the system leave out, with their sizes."""
    supported: tuple[SupportedFrequency, ...] = ()
    """Highest frequencies that the discretisation of the system supports."""
    summary: Evaluation | None = None
    """Quantities delivered as numbers in place of a record."""
    study: StudyResult = field(default_factory=StudyResult)
    """Result of a study; empty for a single run."""
    case_digest: str | None = None
    """Digest of the case that the record was made for, as the record states it."""
    digest: str | None = None
    """SHA-256 of the files of the record; None for a record that was never in a file."""
    start: StartTable | None = None
    """Start of the run, as the system states it."""
    uplift_forces: tuple[float, ...] = ()
    """Uplift force of every pantograph in the run [N]; empty: not known."""
    fmus: tuple[FmuRun, ...] = ()
    """FMUs that moved pantographs."""
    fmu_outputs: Mapping[str, RealArray] = field(default_factory=dict)
    """Recorded outputs of FMUs, (n,) each, by their names in a record."""
    line_shape: LineShape | None = None
    """Line at rest for a drawing; None: not known."""
    motion: PassageMotion | None = None
    """Moving picture of the passage; None: none was made."""
    refined: "Delivered | None" = None
    """The same case with element length and time step halved, for the discretisation error."""
    coarse: "Delivered | None" = None
    """The same case with element length and time step doubled, for the observed order of convergence."""
    changed_lines: "tuple[Delivered, ...]" = ()
    """The same case on lines one standard deviation away, along each principal direction of the tolerances."""
    starts: "tuple[Delivered, ...]" = ()
    """The same case with other starts, for the uncertainty of a short run-in."""


@dataclass(frozen=True)
class Skipped:
    """The system does not run this case; `reason` is one line for the report."""

    reason: str


@dataclass(frozen=True)
class Errored:
    """The system failed on this case; `reason` is one line for the report."""

    reason: str


Outcome = Delivered | Skipped | Errored


def note_case_version(case_digest: str | None) -> tuple[str, ...]:
    """Note on a record that states its case, but not the digest of its inputs."""
    if case_digest is not None:
        return ()
    return ("The sidecar has no case_digest: the case may have changed since the record was made.",)


def missing_record_reason(outcome: Outcome) -> str:
    """Reason why an outcome holds no record."""
    return "the system delivered no record" if isinstance(outcome, Delivered) else outcome.reason


SystemKind = Literal["builtin", "record", "command"]


class System(Protocol):
    """Interface of a system under test. Systems are sent to other processes, so they contain plain data only."""

    @property
    def name(self) -> str:
        """Name in reports."""

    @property
    def version(self) -> str:
        """Version in reports."""

    @property
    def kind(self) -> SystemKind:
        """Kind of the system."""

    def run(self, case: Case) -> Outcome:
        """Run a case. An exception becomes the verdict `error` of this case only."""


# System of a user's own code, which receives only cases whose features it lists.
@dataclass(frozen=True)
class ListedSystem:
    """System with an optional attribute `features`; it receives only cases whose features it lists."""

    system: System

    @property
    def name(self) -> str:
        """Name in reports."""
        return self.system.name

    @property
    def version(self) -> str:
        """Version in reports."""
        return self.system.version

    @property
    def kind(self) -> SystemKind:
        """Kind of the system."""
        return self.system.kind

    def run(self, case: Case) -> Outcome:
        """Run a case if the system simulates all of its features."""
        features = getattr(self.system, "features", None)
        reason = find_missing_features(case, features)
        return self.system.run(case) if reason is None else Skipped(reason)
