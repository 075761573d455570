"""The TOML file beside a record."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    NumberList,
    PositiveList,
    validation_problem,
)

RECORD_SCHEMA = "pantocheck.record/1"

Speed = Annotated[float, Field(ge=1, le=600, description="speed of the train [km/h]")]
Cutoff = Annotated[
    float | Literal["none"],
    Field(description='cut-off of the low-pass the force has been through [Hz], or "none" if it is unfiltered'),
]


class SystemTable(InputTable):
    """What the record comes from: a simulator or a measuring system."""

    name: Annotated[str, Field(max_length=200, description="name of the simulator or measuring system")]
    version: Annotated[str, Field(max_length=200, description="its version")] = ""


class RunTable(InputTable):
    """How a simulated record was computed; all may be left out."""

    simulated_s: Annotated[float | None, Field(gt=0, description="time simulated [s]")] = None
    wall_s: Annotated[float | None, Field(ge=0, description="time the computation took [s]")] = None
    dt_s: Annotated[float | None, Field(gt=0, description="time step [s]")] = None
    element_m: Annotated[float | None, Field(gt=0, description="length of an element [m]")] = None


class LineTable(InputTable):
    """What is known of the line beside the samples; all may be left out. Profiles grade by it."""

    span_m: Annotated[
        float | None, Field(ge=5, le=200, description="length of a span, over which the force repeats itself [m]")
    ] = None
    wave_speed_m_s: Annotated[
        float | None, Field(gt=0, le=1000, description="speed of transverse waves on the contact wire [m/s]")
    ] = None
    uplift_space_mm: Annotated[
        NonNegative | None, Field(le=2000, description="space that is free for uplift at the supports [mm]")
    ] = None


class RecordSidecar(InputTable):
    """What a table of samples is."""

    schema_: Annotated[
        Literal["pantocheck.record/1"],
        Field(alias="schema", description='version of the format: "pantocheck.record/1"'),
    ]
    case: Annotated[str | None, Field(max_length=200, description="id of the case that was run")] = None
    file: Annotated[str, Field(min_length=1, max_length=500, description="the table of samples, beside the sidecar")]
    sha256: Annotated[
        str | None, Field(pattern="^[0-9a-f]{64}$", description="digest of the table, to notice a damaged copy")
    ] = None
    speed_km_h: Speed
    pantographs: Annotated[int, Field(ge=1, le=20, description="number of pantographs")]
    evaluated_m: Annotated[
        NumberList | None,
        Field(
            min_length=2,
            max_length=2,
            description="start and end of the evaluated stretch [m]; left out: that of the case, or all of the record",
        ),
    ] = None
    filter_applied_Hz: Cutoff
    start_m: Annotated[
        float, Field(description="where the first pantograph is at the first sample, if the table has no position [m]")
    ] = 0.0
    spacing_m: Annotated[
        PositiveList | None,
        Field(max_length=19, description="distances between the pantographs, from the front, if not in the table [m]"),
    ] = None
    support_position_m: Annotated[
        NumberList | None, Field(description="supports whose uplift is in the table, in its order [m]")
    ] = None
    line: LineTable = LineTable()
    system: SystemTable | None = None
    run: RunTable = RunTable()

    @model_validator(mode="after")
    def _consistent(self) -> "RecordSidecar":
        check_cutoff(self.filter_applied_Hz)
        if self.evaluated_m is not None and self.evaluated_m[0] >= self.evaluated_m[1]:
            raise validation_problem("evaluated_m", "the stretch ends before it begins", "Give its start and its end.")
        if "/" in self.file or "\\" in self.file or self.file in {".", ".."} or "\0" in self.file:
            raise validation_problem(
                "file", f"{self.file!r} is a path", "The table lies beside its sidecar: give its name alone."
            )
        if self.spacing_m is not None and len(self.spacing_m) != self.pantographs - 1:
            raise validation_problem(
                "spacing_m",
                f"{len(self.spacing_m)} distances for {self.pantographs} pantographs",
                "Give one distance between each two neighbours, from the front.",
            )
        return self

    @property
    def behind(self) -> tuple[float, ...]:
        """How far each pantograph runs behind the first [m]; all at one place if the sidecar does not say."""
        spacing = self.spacing_m or (0.0,) * (self.pantographs - 1)
        return tuple(float(sum(spacing[:i])) for i in range(self.pantographs))

    @property
    def low_passed_Hz(self) -> float | None:
        """Cut-off the force has been through [Hz]; None: unfiltered."""
        return None if isinstance(self.filter_applied_Hz, str) else self.filter_applied_Hz

    def rows(self, per: str) -> int:
        """How many rows a channel has: one per `pantograph` or `support`, or one for the `record`."""
        return {"record": 1, "pantograph": self.pantographs, "support": len(self.support_position_m or ())}[per]


def check_cutoff(value: float | str) -> None:
    """Refuse a cut-off that is none; for validators."""
    if not isinstance(value, str) and value <= 0:
        raise validation_problem(
            "filter_applied_Hz",
            f"{value:g} Hz is not a cut-off",
            'Write filter_applied_Hz = "none" for an unfiltered force.',
        )
