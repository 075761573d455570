"""Identified modes, and modes.json, the file of their list."""

from pathlib import Path
from typing import Annotated

from pydantic import ConfigDict, Field, RootModel, TypeAdapter

from pantocheck.conformance.core.json_file import Rounded, RoundedModel, read_json, validate_json

MAX_MODES_BYTES = 50_000_000
"""Largest accepted size of a modes.json [bytes]."""


class SensorShape(RoundedModel):
    """Complex component of a mode shape at one sensor."""

    model_config = ConfigDict(allow_inf_nan=False)

    sensor: int
    """Number of the sensor."""
    wire: str = ""
    """Wire with the sensor: CW (contact wire) or MW (messenger wire); empty: unknown."""
    position_m: float | None = None
    """Distance from the first support [m]; null: unknown."""
    re: Rounded
    """Real part [-]; the largest component of a shape is 1."""
    im: Rounded
    """Imaginary part [-]."""
    std: Rounded | None = None
    """Standard deviation of real and imaginary part [-]."""
    error: Rounded | None = None
    """Residual over measured signal in the half-power band at this sensor [-]."""


class MeasuredLine(RoundedModel):
    """Properties of the line of a record, which a damping fit compares with its line."""

    model_config = ConfigDict(allow_inf_nan=False)

    spans_m: tuple[Rounded, ...] = ()
    """Lengths of the spans [m]; empty: unknown."""
    contact_wire_tension_N: Rounded | None = None
    """Tension of one contact wire [N]; null: unknown."""
    messenger_wire_tension_N: Rounded | None = None
    """Tension of one messenger wire [N]; null: unknown."""


class Mode(RoundedModel):
    """Identified mode of a line."""

    model_config = ConfigDict(allow_inf_nan=False)

    frequency_Hz: Annotated[Rounded, Field(gt=0)]
    """Undamped natural frequency [Hz]."""
    frequency_std_Hz: Rounded | None = None
    """Standard deviation of the frequency [Hz]."""
    damping_ratio: Annotated[Rounded, Field(gt=0, lt=1)]
    """Damping ratio [-]."""
    damping_ratio_std: Annotated[Rounded, Field(ge=0)]
    """Standard deviation of the damping ratio [-]."""
    group: int | None = None
    """Number of the group of span modes, from 1; null: none."""
    sensor_shape: tuple[SensorShape, ...]
    """Mode shape at the sensors of `record`."""
    error: Rounded | None = None
    """Residual over measured signal in the half-power band [-]."""
    record: str = ""
    """Name of the record with the largest signal of the mode over noise."""
    line: MeasuredLine | None = None
    """Line of `record`; null: unknown."""
    warnings: tuple[str, ...] = ()
    """Caveats on the mode."""
    certain: bool = True
    """true: standard deviation below 5 % of the damping ratio."""
    outlier: bool = False
    """true: damping ratio far from those of its group."""
    lateral: bool = False
    """true: lateral mode, measured by vertical channels because of oblique mounting."""
    amplitude_at_release: Rounded | None = None
    """Largest amplitude of a sensor at the release [unit of the record]."""
    phase_collinearity: Rounded | None = None
    """Modal phase collinearity [-], 1 for a normal mode; null: single sensor."""
    lateral_over_vertical: Rounded | None = None
    """Largest lateral over largest vertical amplitude [-]; null: no lateral channel."""
    half_power_points: Rounded | None = None
    """Number of spectral lines in the half-power band."""


class ModesFile(RootModel[tuple[Mode, ...]]):
    """Content of modes.json: modes of all lines, in the order of frequency within a line."""


def read_modes(path: Path) -> tuple[Mode, ...]:
    """Read a modes.json.

    Raises:
        InputError: The file cannot be read, is not JSON, or is not a list of modes.
    """
    data = read_json(path, "modes", MAX_MODES_BYTES)
    hint = "Give the modes.json that `pantocheck drop identify` writes."
    return tuple(validate_json(data, TypeAdapter(list[Mode]), f"modes '{path.name}'", hint))
