"""Limits of a drop comparison: a TOML file of the user, which names every sensor that must agree."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.comparison.motion_bands import MOTION_BANDS, MotionBand
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, NonNegative, Positive, validation_problem
from pantocheck.conformance.input_files.toml_file import read_model

ComparedMotion = Literal["velocity", "acceleration"]
DropQuantity = Literal["rms_ratio", "correlation"]
TimeWindow = tuple[float, float]


class DropLimit(InputTable):
    """Bounds of the agreement between model and record at some sensors, in one window and band."""

    quantity: Annotated[
        DropQuantity,
        Field(description="rms_ratio: RMS of the model over that of the record; correlation: of their samples"),
    ]
    motion: Annotated[ComparedMotion, Field(description="compared motion")] = "acceleration"
    sensors: Annotated[
        tuple[Annotated[int, Field(ge=1)], ...],
        Field(
            strict=False,
            min_length=1,
            max_length=100,
            description="numbers of the sensors; a sensor without a record leaves its limit open (skip)",
        ),
    ]
    window_s: Annotated[
        tuple[NonNegative, Positive],
        Field(strict=False, description="start and end of a compared window after the release [s]"),
    ]
    band_Hz: Annotated[
        tuple[Positive, Positive],
        Field(strict=False, description="edges of a compared band [Hz]: 0.3-5, 5-20, 20-50 or 0.3-20"),
    ]
    lower: Annotated[float | None, Field(ge=-1, le=1e3, description="lower bound [-]")] = None
    upper: Annotated[float | None, Field(ge=-1, le=1e3, description="upper bound [-]")] = None
    note: Annotated[str | None, Field(description="reason for the bounds", max_length=4000)] = None

    @cross_check
    def _check_bounds(self) -> Problems:
        if self.lower is None and self.upper is None:
            yield validation_problem("", f"the limit of {self.quantity} has no bound", "Give lower, upper or both.")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            yield validation_problem(
                "lower", f"{self.lower:g} is above upper = {self.upper:g}", "Give the smaller number as lower."
            )

    @cross_check
    def _check_sensors(self) -> Problems:
        if len(set(self.sensors)) < len(self.sensors):
            yield validation_problem("sensors", f"{list(self.sensors)} repeats a sensor", "Name each sensor once.")

    @cross_check
    def _check_band(self) -> Problems:
        if self.band_Hz not in MOTION_BANDS:
            names = ", ".join(str(list(band)) for band in MOTION_BANDS)
            yield validation_problem("band_Hz", f"{list(self.band_Hz)} is not a compared band", f"Give one of {names}.")

    @property
    def band(self) -> MotionBand:
        """Frequency band."""
        return MotionBand(*self.band_Hz)


class DropLimits(InputTable):
    """File of the limits of a drop comparison."""

    schema_: Annotated[
        Literal["pantocheck.drop-limits/1"],
        Field(alias="schema", description='version of the format: "pantocheck.drop-limits/1"'),
    ]
    limit: Annotated[tuple[DropLimit, ...], Field(strict=False, min_length=1, max_length=1000)]

    @property
    def sensors(self) -> tuple[int, ...]:
        """Numbers of all sensors with a limit."""
        return tuple(dict.fromkeys(sensor for limit in self.limit for sensor in limit.sensors))

    def find_unknown_window(self, windows: tuple[TimeWindow, ...]) -> tuple[int, TimeWindow] | None:
        """Number (from 1) and window of the first limit whose window is not compared; None if there is none."""
        return next(
            ((number, limit.window_s) for number, limit in enumerate(self.limit, 1) if limit.window_s not in windows),
            None,
        )


def read_drop_limits(path: Path) -> DropLimits:
    """Read a file of limits.

    Raises
    ------
    InputError
        The file cannot be read, or does not fit the format.
    """
    return read_model(path, DropLimits, "limits")
