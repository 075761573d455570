"""The TOML file beside a record that says what its columns are."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from pantocheck.conformance.input_files.toml_file import read_model

PositiveNumber = Annotated[float, Field(gt=0)]


class _Open(BaseModel):
    """A table in which a measuring team may keep keys of its own."""

    model_config = ConfigDict(extra="ignore", frozen=True, strict=True, allow_inf_nan=False)


class DropTestTable(_Open):
    """The test and its line."""

    name: Annotated[str, Field(max_length=200, description="name of the test")] = ""
    spans_m: Annotated[
        tuple[PositiveNumber, ...], Field(strict=False, max_length=1000, description="lengths of the spans [m]")
    ] = ()
    cw_tension_n: Annotated[float | None, Field(gt=0, description="tension of the contact wire [N]")] = None
    mw_tension_n: Annotated[float | None, Field(gt=0, description="tension of the messenger wire [N]")] = None


class DropTable(_Open):
    """The mass."""

    mass_kg: Annotated[float | None, Field(gt=0, le=1000, description="mass dropped [kg]")] = None
    wire: Annotated[str, Field(max_length=20, description="wire it hung from: CW or MW")] = ""
    position_m: Annotated[float | None, Field(description="where it hung, from the first support [m]")] = None


class DropRecordTable(_Open):
    """The recording."""

    sampling_rate_hz: Annotated[float, Field(gt=0, le=1e6, description="samples per second [Hz]")]
    trigger_nominal_s: Annotated[float | None, Field(ge=0, description="when the release was planned [s]")] = None
    n_channels: Annotated[int | None, Field(ge=1, description="number of columns")] = None
    quantity: Annotated[
        Literal["acceleration", "velocity", "displacement"] | None, Field(description="what the sensors measure")
    ] = None


class DropChannelTable(_Open):
    """A column."""

    column: Annotated[int, Field(ge=1, le=10000, description="number of the column, from 1, time not counted")]
    name: Annotated[str, Field(max_length=100, description="name of the channel")]
    sensor: Annotated[int, Field(ge=0, description="number of the sensor")]
    wire: Annotated[str, Field(max_length=20, description="wire it sits on: CW or MW")] = ""
    position_m: Annotated[float | None, Field(description="where it sits, from the first support [m]")] = None
    direction: Annotated[str, Field(max_length=10, description="+x, -x, +y, -y, +z or -z")]
    unit: Annotated[str, Field(max_length=40, description="m/s2, g, ...")]


class DropSidecar(_Open):
    """A sidecar file."""

    test: DropTestTable = DropTestTable()
    drop: DropTable = DropTable()
    record: DropRecordTable
    channel: Annotated[tuple[DropChannelTable, ...], Field(strict=False, min_length=1, description="one per column")]


def find_drop_sidecar(record: Path) -> Path:
    """Where the sidecar of a record is looked for: beside it, with the same stem."""
    return record.with_suffix(".toml")


def read_drop_sidecar(record: Path) -> DropSidecar | None:
    """The sidecar of a record, None if there is none.

    Raises
    ------
    InputError
        It cannot be read or is wrong.
    """
    path = find_drop_sidecar(record)
    return read_model(path, DropSidecar, "sidecar") if path.is_file() else None
