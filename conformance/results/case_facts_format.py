"""Facts on a case in results.json: contact losses, events, derived values, inputs, force laws, record, other runs."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from pantocheck.conformance.core.check_row import CheckRow
from pantocheck.conformance.core.figure_data import Chart, Spectrum, check_lengths
from pantocheck.conformance.core.results_part import FiniteNumber, Number, Owner, ResultsPart, is_empty
from pantocheck.conformance.core.trust import StudiedPart, Trust
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.quantities.filters import Filter


class ContactLossFacts(ResultsPart):
    """Contact loss of a pantograph in its unfiltered force."""

    position_m: float
    """Position of the pantograph at the start of the loss [m]."""
    time_s: float
    """Time from the start of the analysis section [s]."""
    duration_s: float
    lowest_force_N: float


class SupportPassage(ResultsPart):
    """Passage of a pantograph at a support of a source."""

    support_m: FiniteNumber
    pantograph: int
    passing_s: FiniteNumber
    """Time of the record at which the pantograph passes, by its position [s]."""
    pulse_s: FiniteNumber | None
    """Time of the pulse of the uplift by the clock of the source [s]; null: none was found."""


class SourceFacts(ResultsPart):
    """Further source of a record, and its clock: time of the record = time of the source + offset + drift."""

    name: str
    """Name of the file, with the number of the source if several have the same."""
    record: Literal["graded", "measured"]
    """Record of the source: the graded one, or the measured one that it is compared with."""
    join: Literal["time", "pps", "marks", "passage"]
    rate_Hz: FiniteNumber | None
    """Sampling rate of the uplift; null: the source gives position or speed."""
    state: Literal["confirmed", "unconfirmed", "contradicted"]
    """Comparison of the clock with the pulses of the uplift."""
    finding: str
    """This comparison in words."""
    offset_s: FiniteNumber
    uncertainty_s: FiniteNumber
    """Half-width of the 95 % interval of a time; of a passage that was not found, the range of the search."""
    drift_ppm: FiniteNumber
    """Drift that was corrected; 0: it is not significant."""
    drift_uncertainty_ppm: FiniteNumber | None
    """Half-width of the 95 % interval of the drift; null: not known."""
    passages: list[SupportPassage] = []
    chart: Annotated[Chart | None, Field(exclude_if=lambda chart: chart is None)] = None
    """Uplift around the passages; missing: the source has no uplift."""


class DerivedFact(ResultsPart):
    """Value that follows from the inputs of a case or, for a tuned force, from its run."""

    name: str
    """Name of the value."""
    value: FiniteNumber
    unit: str
    """Unit; empty for a ratio."""
    basis: str
    """Inputs or formula from which the value follows."""


class ConditionFacts(ResultsPart):
    """Input that is not traced or left open, and the changes of the values by another one."""

    name: str
    group: StudiedPart
    not_applicable: str | None = None
    """Reason why the case does not support this change."""
    changes: dict[Owner, dict[str, FiniteNumber]] = {}
    """Changes by owner and quantity, relative to the value with the inputs of the case [%]."""

    @property
    def is_contact(self) -> bool:
        """Whether the other input is the contact of head and wire."""
        return self.group == "contact"


class StoredRange(ResultsPart):
    """Number of the values of a long list, and their range."""

    count: int
    lowest: FiniteNumber
    highest: FiniteNumber


StoredValue = bool | FiniteNumber | str | list[FiniteNumber | str] | StoredRange


StoredValues = Annotated[
    dict[str, StoredValue],
    Field(
        description="values by dotted key, with the unit at its end; of a list of tables, the values of a key in order"
    ),
]


class AppliedForceFacts(ResultsPart):
    """Applied forces of a pantograph; its mean contact force is a result."""

    kind: Literal["applied_forces"] = "applied_forces"
    static_force_N: FiniteNumber
    """Static force [N]."""
    aerodynamic_force_N: FiniteNumber
    """Aerodynamic force at the speed of the case [N]."""

    @property
    def text(self) -> str:
        """Both forces and their sum, in words."""
        total = self.static_force_N + self.aerodynamic_force_N
        return (
            f"applied forces of {total:.2f} N: static force {self.static_force_N:.2f} N, aerodynamic force "
            f"{self.aerodynamic_force_N:.2f} N; not tuned, the mean contact force is a result"
        )


class MeanForceFacts(ResultsPart):
    """Mean contact force to which the uplift force of a pantograph is tuned."""

    kind: Literal["mean_force"] = "mean_force"
    mean_force_N: FiniteNumber
    """Mean contact force at the speed of the case [N]."""

    @property
    def text(self) -> str:
        """Mean contact force in words."""
        return f"mean contact force of {self.mean_force_N:.2f} N; the uplift force is tuned to it"


LiftForceFacts = Annotated[AppliedForceFacts | MeanForceFacts, Field(discriminator="kind")]


LawForces = Annotated[
    dict[Owner, LiftForceFacts],
    Field(
        exclude_if=lambda forces: not forces,
        description="forces of the pantographs whose force law applies, at the speed of the case",
    ),
]
"""Forces by the number of the pantograph as text."""


class EventFacts(ResultsPart):
    """Stretch of the line inside the analysis section; positions [m] in running direction."""

    kind: str
    name: str
    start_m: float
    end_m: float
    excluded: bool
    """Whether the statistics of the contact force leave it out."""
    remark: str = ""
    """Stated reason of the exclusion, or why it is not applied."""


# Record of the case.
RecordState = Literal["consistent", "unconfirmed", "contradicted"]
"""Result of the consistency checks of a record: confirmed, not all of them possible, or refuted."""

StartState = Literal["as in the case", "differs", "not stated"]
"""Start of a record against that of its case; `not stated` is never treated better than `as in the case`."""


class RecordFacts(ResultsPart):
    """Record of a case. Digests are SHA-256 in hexadecimal, null if unknown.

    `demanded` is false if a profile shows the state `unconfirmed` without lowering the verdict. `digest` is that of the
    record. `case_digest` is that of the case for which the record was made, as the record states it. `measured_digest`
    is that of the measured record, if a profile compares with one. `start` compares the stated start of the record with
    that of its case, null without a case; `start_text` is the remark on it.
    """

    state: RecordState
    reason: str
    demanded: bool = True
    digest: str | None = None
    case_digest: str | None = None
    measured_digest: str | None = None
    start: StartState | None = None
    start_text: str | None = None
    checks: tuple[CheckRow, ...] = ()
    """All consistency checks in their order; empty for a record without samples, and for a profile."""


class ReadingFacts(ResultsPart):
    """Values under another documented reading of the evaluation."""

    id: str
    trust: Trust
    source: str
    filter: Filter
    evaluated_m: Annotated[tuple[float, float], Field(strict=False)]
    quantities: dict[Owner, dict[str, Number]]
    reason: str | None = None
    """Reason why the record does not support this reading; null: it does."""


# Earlier results, a measured run and the reference simulator beside the case.
class BaselineComparison(ResultsPart):
    """Comparison of the values of a case with earlier results.

    Its criteria stand among those of the case: their `trust` is null, because their bounds are earlier values and no
    limits of a standard. A value that has not drifted has no such criterion.
    """

    verdict: Verdict
    """Worst of its criteria; info: no value was compared."""
    name: str
    """Name of the file with the earlier results."""
    drift_pct: Annotated[FiniteNumber, Field(gt=0)]
    """Largest accepted drift of a value [%]."""
    values: Annotated[int, Field(ge=0)]
    """Number of values of the baseline; 0: no comparison is possible."""
    drifted: Annotated[int, Field(ge=0)]
    """Number of values that drifted or are missing."""


class ForceStatistics(ResultsPart):
    """Statistics of the filtered contact force over one span [N]."""

    mean_N: FiniteNumber
    std_N: FiniteNumber
    max_N: FiniteNumber
    min_N: FiniteNumber


class SpanStatistics(ResultsPart):
    """Statistics of both runs over one span."""

    start_m: FiniteNumber
    end_m: FiniteNumber
    simulated: ForceStatistics
    measured: ForceStatistics


class MeasuredPantograph(ResultsPart):
    """Filtered contact force of one pantograph in both runs, at the same positions of their common track."""

    position_m: list[float]
    simulated_N: list[float]
    measured_N: list[float]
    simulated_spectrum: Spectrum
    measured_spectrum: Spectrum
    spans: list[SpanStatistics]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.position_m, self.simulated_N, self.measured_N)


class MeasuredRun(ResultsPart):
    """Measured run beside the simulated one of its case."""

    name: str
    """Name of the measured record."""
    cutoff_Hz: float
    """Cut-off of the filter of the drawn forces [Hz]."""
    quantities: dict[Owner, dict[str, Number]]
    """Quantities of the measured run, as those of the case."""
    uncertainty: dict[Owner, dict[str, Number]]
    """Half-widths of their 95 % intervals, as in `quantities`."""
    pantographs: dict[Owner, MeasuredPantograph]


class ReferenceValues(ResultsPart):
    """Run of the reference simulator on the same case. It takes part in no verdict."""

    name: str
    """Name of the reference simulator."""
    version: str
    reason: str | None
    """Reason why there are no values; null: there are."""
    quantities: dict[Owner, dict[str, Number]]
    """As `quantities` of the case."""
    uncertainty: dict[Owner, dict[str, Number]]
    """Half-widths of the 95 % intervals, as in `quantities`."""
    force_20_N: dict[Owner, list[float]]
    """Filtered force at the positions of `traces` of the case, which has the same pantograph."""


class FmuOutput(ResultsPart):
    """Output of an FMU in a passage."""

    name: str
    unit: str
    """As the FMU states it; empty: not stated."""
    lowest: FiniteNumber
    highest: FiniteNumber


class FmuRun(ResultsPart):
    """FMU that moved a pantograph in a run, and the accuracy of its coupling with the line."""

    pantograph: int
    file: str
    """Name of the archive."""
    sha256: str
    """Digest of the archive."""
    model: str
    """Name and version of the model, as the FMU states them."""
    tool: str
    """Tool that generated the FMU, as it states; empty: not stated."""
    interface: str
    """Version of FMI, and interface that was used."""
    can_repeat: bool
    """Whether steps were repeated until line and FMU agreed."""
    energy_J: FiniteNumber
    """Energy that the coupling made."""
    exchanged_J: FiniteNumber
    """Sum of the absolute work of all steps between line and FMU."""
    largest_difference_mm: FiniteNumber
    """Largest difference of the heights of a strip in line and FMU at the end of a step."""
    outputs: Annotated[list[FmuOutput], Field(exclude_if=is_empty)] = []
    """Recorded outputs; missing: none."""

    @property
    def description(self) -> str:
        """Sentences for the reader of a report."""
        way = "steps repeated until both agree" if self.can_repeat else "explicit steps, without state rollback"
        tool = f" by {self.tool}" if self.tool else ""
        outputs = (f" {row.name}: {row.lowest:.4g} to {row.highest:.4g} {row.unit}".rstrip() for row in self.outputs)
        return (
            f"Pantograph {self.pantograph} was moved by the FMU {self.file}: {self.model}{tool}, {self.interface},"
            f" SHA-256 {self.sha256}. Coupling: {way}; it made {self.energy_J:.2g} J where {self.exchanged_J:.3g} J"
            f" were exchanged, and heights differ by {self.largest_difference_mm:.1g} mm at most."
            + ("" if not self.outputs else f" Outputs:{';'.join(outputs)}.")
        )
