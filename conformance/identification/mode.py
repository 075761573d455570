"""Identified modes, and modes.json, the file of their list."""

from pathlib import Path
from typing import Annotated

from pydantic import ConfigDict, Field, RootModel, TypeAdapter

from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.input_files.json_file import read_json, validate_json

MAX_MODES_BYTES = 50_000_000
"""Largest accepted size of a modes.json [bytes]."""


class SensorShape(RoundedModel):
    """Complex component of a mode shape at one sensor."""

    model_config = ConfigDict(allow_inf_nan=False)

    sensor: Annotated[int, Field(description="number of the sensor")]
    wire: Annotated[str, Field(description="wire: CW (contact wire) or MW (messenger wire); empty: unknown")] = ""
    position_m: Annotated[float | None, Field(description="distance from the first support [m]; null: unknown")] = None
    re: Annotated[Rounded, Field(description="real part [-]; the largest component of a shape is 1")]
    im: Annotated[Rounded, Field(description="imaginary part [-]")]
    std: Annotated[Rounded | None, Field(description="standard deviation of real and imaginary part [-]")] = None


class MeasuredLine(RoundedModel):
    """Properties of the line of a record, which a damping fit compares with its line."""

    model_config = ConfigDict(allow_inf_nan=False)

    spans_m: Annotated[tuple[Rounded, ...], Field(description="lengths of the spans [m]; empty: unknown")] = ()
    contact_wire_tension_N: Annotated[
        Rounded | None, Field(description="tension of one contact wire [N]; null: unknown")
    ] = None
    messenger_wire_tension_N: Annotated[
        Rounded | None, Field(description="tension of one messenger wire [N]; null: unknown")
    ] = None


class Mode(RoundedModel):
    """Identified mode of a line."""

    model_config = ConfigDict(allow_inf_nan=False)

    frequency_Hz: Annotated[Rounded, Field(gt=0, description="undamped natural frequency [Hz]")]
    frequency_std_Hz: Annotated[Rounded | None, Field(description="standard deviation of the frequency [Hz]")] = None
    damping_ratio: Annotated[Rounded, Field(gt=0, lt=1, description="damping ratio [-]")]
    damping_ratio_std: Annotated[Rounded, Field(ge=0, description="standard deviation of the damping ratio [-]")]
    group: Annotated[int | None, Field(description="number of the group of span modes, from 1; null: none")] = None
    sensor_shape: Annotated[tuple[SensorShape, ...], Field(description="mode shape at the sensors of `record`")]
    error: Annotated[Rounded | None, Field(description="residual over measured signal in the half-power band [-]")] = (
        None
    )
    record: Annotated[str, Field(description="name of the record with the largest signal of the mode over noise")] = ""
    line: Annotated[MeasuredLine | None, Field(description="line of `record`; null: unknown")] = None
    warnings: Annotated[tuple[str, ...], Field(description="caveats on the mode")] = ()
    certain: Annotated[bool, Field(description="true: standard deviation below 5 % of the damping ratio")] = True
    outlier: Annotated[bool, Field(description="true: damping ratio far from those of its group")] = False
    lateral: Annotated[
        bool, Field(description="true: lateral mode, measured by vertical channels because of oblique mounting")
    ] = False
    amplitude_at_release: Annotated[
        Rounded | None, Field(description="largest amplitude of a sensor at the release [unit of the record]")
    ] = None
    phase_collinearity: Annotated[
        Rounded | None, Field(description="modal phase collinearity [-], 1 for a normal mode; null: single sensor")
    ] = None
    lateral_over_vertical: Annotated[
        Rounded | None,
        Field(description="largest lateral over largest vertical amplitude [-]; null: no lateral channel"),
    ] = None
    half_power_points: Annotated[
        Rounded | None, Field(description="number of spectral lines in the half-power band")
    ] = None


class ModesFile(RootModel[tuple[Mode, ...]]):
    """Content of modes.json: modes of all lines, in the order of frequency within a line."""


def read_modes(path: Path) -> tuple[Mode, ...]:
    """Read a modes.json.

    Raises
    ------
    InputError
        The file cannot be read, is not JSON, or is not a list of modes.
    """
    data = read_json(path, "modes", MAX_MODES_BYTES)
    hint = "Give the modes.json that `pantocheck drop identify` writes."
    return tuple(validate_json(data, TypeAdapter(list[Mode]), f"modes '{path.name}'", hint))
