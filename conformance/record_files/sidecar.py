"""The TOML file beside a record."""

from typing import Annotated, Literal

from pantocheck.conformance.cases.base import NumberList, Table, problem
from pydantic import Field, model_validator

SCHEMA = "pantocheck.record/1"


class SystemTable(Table):
    """What the record comes from: a simulator or a measuring system."""

    name: Annotated[str, Field(max_length=200, description="name of the simulator or measuring system")]
    version: Annotated[str, Field(max_length=200, description="its version")] = ""


class RunTable(Table):
    """How a simulated record was computed; all may be left out."""

    simulated_s: Annotated[float | None, Field(gt=0, description="time simulated [s]")] = None
    wall_s: Annotated[float | None, Field(ge=0, description="time the computation took [s]")] = None
    dt_s: Annotated[float | None, Field(gt=0, description="time step [s]")] = None
    element_m: Annotated[float | None, Field(gt=0, description="length of an element [m]")] = None


class Sidecar(Table):
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
    speed_km_h: Annotated[float, Field(ge=1, le=600, description="speed of the train [km/h]")]
    pantographs: Annotated[int, Field(ge=1, le=20, description="number of pantographs")]
    evaluated_m: Annotated[
        NumberList, Field(min_length=2, max_length=2, description="start and end of the evaluated stretch [m]")
    ]
    filter_applied_Hz: Annotated[
        float | Literal["none"],
        Field(description='cut-off of the low-pass the force has been through [Hz], or "none" if it is unfiltered'),
    ]
    support_position_m: Annotated[
        NumberList | None, Field(description="supports whose uplift is in the table, in its order [m]")
    ] = None
    system: SystemTable | None = None
    run: RunTable = RunTable()

    @model_validator(mode="after")
    def _consistent(self) -> "Sidecar":
        if isinstance(self.filter_applied_Hz, float | int) and self.filter_applied_Hz <= 0:
            raise problem(
                "filter_applied_Hz",
                f"{self.filter_applied_Hz:g} Hz is not a cut-off",
                'Write filter_applied_Hz = "none" for an unfiltered force.',
            )
        if self.evaluated_m[0] >= self.evaluated_m[1]:
            raise problem("evaluated_m", "the stretch ends before it begins", "Give its start and its end.")
        if "/" in self.file or "\\" in self.file:
            raise problem("file", f"{self.file!r} is a path", "The table lies beside its sidecar: give its name alone.")
        return self

    def columns(self) -> dict[str, int]:
        """Channels a table may have, by key with its unit, and how many rows each has (time: one)."""
        rows = {
            "time_s": 1,
            "position_m": self.pantographs,
            "force_N": self.pantographs,
            "contact_height_m": self.pantographs,
        }
        return rows | ({"uplift_m": len(self.support_position_m)} if self.support_position_m else {})


REQUIRED = ("time_s", "position_m", "force_N")


def column_name(key: str, number: int) -> str:
    """Name of a CSV column: `force_N` of pantograph 2 is `force_2_N`."""
    stem, unit = key.rsplit("_", 1)
    return key if key == "time_s" else f"{stem}_{number}_{unit}"
