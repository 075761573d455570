"""Sidecar of a mass-drop record: TOML file with the descriptions of its columns, its mass drop and its line."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from pantocheck.conformance.input_files.measured_table import TableColumn
from pantocheck.conformance.input_files.text_settings import TextSettings
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.input_files.units import MotionQuantity

PositiveNumber = Annotated[float, Field(gt=0)]


class _OpenTable(BaseModel):
    """Table in which further keys are permitted and ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True, strict=True, allow_inf_nan=False)


class DropTestTable(_OpenTable):
    """Name of the test, and its line."""

    name: Annotated[str, Field(max_length=200)] = ""
    """Name of the test."""
    spans_m: Annotated[tuple[PositiveNumber, ...], Field(strict=False, max_length=1000)] = ()
    """Lengths of the spans [m]."""
    cw_tension_n: Annotated[float | None, Field(gt=0)] = None
    """Tension of one contact wire [N]."""
    mw_tension_n: Annotated[float | None, Field(gt=0)] = None
    """Tension of one messenger wire [N]."""


class DropTable(_OpenTable):
    """Dropped mass."""

    mass_kg: Annotated[float | None, Field(gt=0, le=1000)] = None
    """Dropped mass [kg]."""
    wire: Annotated[str, Field(max_length=20)] = ""
    """Wire with the mass: CW (contact wire) or MW (messenger wire)."""
    position_m: float | None = None
    """Distance of the mass from the first support [m]."""


class DropRecordTable(_OpenTable):
    """Sampling of the record."""

    sampling_rate_hz: Annotated[float, Field(gt=0, le=1e6)]
    """Sampling rate [Hz]."""
    trigger_nominal_s: Annotated[float | None, Field(ge=0)] = None
    """Planned time of the release [s]."""
    n_channels: Annotated[int | None, Field(ge=1)] = None
    """Number of channels."""
    quantity: MotionQuantity | None = None
    """Measured quantity."""


class DropChannelTable(_OpenTable):
    """Column of the record."""

    column: Annotated[int, Field(ge=1, le=10000)]
    """Number of the column from 1, without the time column."""
    name: Annotated[str, Field(max_length=100)]
    """Name of the channel."""
    sensor: Annotated[int, Field(ge=0)]
    """Number of the sensor."""
    wire: Annotated[str, Field(max_length=20)] = ""
    """Wire with the sensor: CW (contact wire) or MW (messenger wire)."""
    position_m: float | None = None
    """Distance of the sensor from the first support [m]."""
    direction: Annotated[str, Field(max_length=10)]
    """Direction of measurement: +x, -x, +y, -y, +z or -z."""
    unit: Annotated[str, Field(max_length=40)]
    """Unit of the samples, such as m/s2 or g."""

    @property
    def description(self) -> TableColumn:
        """Description of the column as in a `MeasuredTable`."""
        return TableColumn(
            self.name,
            unit=self.unit,
            sensor=self.sensor,
            wire=self.wire,
            position=self.position_m,
            direction=self.direction,
        )


class DropSidecar(_OpenTable):
    """Sidecar of a mass-drop record."""

    test: DropTestTable = DropTestTable()
    drop: DropTable = DropTable()
    record: DropRecordTable
    table: TextSettings = TextSettings()
    """Layout of a text table, if it is not found from the file."""
    channel: Annotated[tuple[DropChannelTable, ...], Field(strict=False, min_length=1)]
    """Channels, one per column."""

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels in the order of their columns."""
        return tuple(channel.name for channel in sorted(self.channel, key=lambda channel: channel.column))

    @property
    def attributes(self) -> dict[str, Any]:
        """Stated data of the test, by the names of `MeasuredTable.attributes`."""
        attributes = {
            "test": self.test.name,
            "drop_mass_kg": self.drop.mass_kg,
            "drop_wire": self.drop.wire,
            "drop_position_m": self.drop.position_m,
            "trigger_nominal_s": self.record.trigger_nominal_s,
            "spans_m": self.test.spans_m,
            "cw_tension_n": self.test.cw_tension_n,
            "mw_tension_n": self.test.mw_tension_n,
        }
        return {name: value for name, value in attributes.items() if value not in (None, "", ())}


def read_drop_sidecar(record: Path) -> DropSidecar | None:
    """Read the sidecar of a record, a TOML file with the same stem; None if there is no such file.

    Raises:
        InputError: The sidecar cannot be read or does not fit the model.
    """
    path = record.with_suffix(".toml")
    return read_model(path, DropSidecar, "sidecar") if path.is_file() else None
