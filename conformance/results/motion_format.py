"""Moving picture of a line: shapes of the wires, slack droppers and pantographs at equal times.

Coding of a field of frames and columns: values are rounded to a multiple of a step, as 16-bit numbers, with the lowest
number for a missing value; each is replaced by its difference from the frame before, and this by its difference from
the column before, modulo 2^16, with the sign in the lowest bit; the low bytes of all numbers come first, then the high
ones; zlib compresses them; base64 writes them as text.
"""

import zlib
from base64 import b64decode, b64encode
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import LineShape, check_lengths
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart

MISSING = -(2**15)
"""Number of a missing value."""

MOST_CODED_VALUES = 8_000_000
"""Largest number of values of a field: 4000 frames of 2000 columns."""


class CodedField(ResultsPart):
    """Values of columns over frames, coded."""

    frames: Annotated[int, Field(ge=1)]
    columns: Annotated[int, Field(ge=1)]
    step: Annotated[FiniteNumber, Field(gt=0)]
    """Difference of two neighbouring numbers, in the unit of the values; the error of rounding is half of it."""
    data: Annotated[str, Field(max_length=4 * MOST_CODED_VALUES)]

    def decode(self) -> RealArray:
        """Values, (frames, columns); NaN: missing.

        Raises:
            ValueError: The data have another size, or cannot be unpacked.
        """
        size = 2 * self.frames * self.columns
        if size > 2 * MOST_CODED_VALUES:
            raise ValueError(
                f"a field of {self.frames} x {self.columns} values, at most {MOST_CODED_VALUES} are accepted"
            )
        unpacker = zlib.decompressobj()
        try:
            halves = unpacker.decompress(b64decode(self.data, validate=True), size + 1)
        except (ValueError, zlib.error) as error:
            raise ValueError(f"the field cannot be unpacked ({error})") from None
        if len(halves) != size or not unpacker.eof:
            raise ValueError(f"the field does not have {self.frames} x {self.columns} values")
        signed = np.frombuffer(halves, np.uint8).reshape(2, -1).T.copy().view("<u2").reshape(self.frames, -1)
        differences = (signed >> 1) ^ (0 - (signed & 1))
        numbers = differences.cumsum(1, dtype=np.uint16).cumsum(0, dtype=np.uint16).view(np.int16)
        return np.where(numbers == MISSING, np.nan, self.step * numbers)

    @model_validator(mode="after")
    def _can_be_decoded(self) -> Self:
        self.decode()
        return self


def code_field(values: RealArray, step: float) -> CodedField:
    """Code values, (frames, columns); NaN: missing.

    Args:
        values: Values.
        step: Smallest step of the coded numbers; larger values than 32767 steps widen it.
    """
    present = np.abs(values[np.isfinite(values)])
    step = max(step, float(f"{present.max(initial=0.0) / 32767:.3g}") * 1.01)
    numbers = np.where(np.isfinite(values), np.rint(values / step), MISSING).astype(np.int16).view(np.uint16)
    for axis in (0, 1):
        numbers = np.diff(numbers, axis=axis, prepend=np.uint16(0))
    signed = ((numbers << 1) ^ (0 - (numbers >> 15))).astype("<u2")
    halves = np.ascontiguousarray(signed.reshape(-1).view(np.uint8).reshape(-1, 2).T).tobytes()
    frames, columns = values.shape
    return CodedField(frames=frames, columns=columns, step=step, data=b64encode(zlib.compress(halves, 9)).decode())


class MovingWire(ResultsPart):
    """Rise of a wire above its height at rest."""

    curve: Annotated[int, Field(ge=0)]
    """Index of the wire in the curves of the side view of `line_shape`."""
    x_m: Annotated[list[FiniteNumber], Field(min_length=2)]
    rise_mm: CodedField

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.x_m, [0.0] * self.rise_mm.columns)


class MovingPantograph(ResultsPart):
    """Heights of the masses of a pantograph, base to head, or of its head alone, and its contact force."""

    start_m: FiniteNumber
    """Position in the first frame [m]."""
    masses: list[str]
    """Names of the masses; empty: the model has none, and the only height is that of the head."""
    height_mm: CodedField
    """Heights above the datum of the line."""
    force_N: CodedField
    band_N: CodedField | None
    """Part of the force in the extended band over the analysis section, one column; null: not observable."""
    band_start_s: FiniteNumber
    band_step_s: Annotated[FiniteNumber, Field(gt=0)]


class PassageMotion(ResultsPart):
    """Moving picture of a line under pantographs or free, an illustration: no value and no verdict follows from it."""

    start_s: FiniteNumber
    step_s: Annotated[FiniteNumber, Field(gt=0)]
    """Time of the first frame after the start of the run, and time between two frames."""
    speed_m_s: Annotated[FiniteNumber, Field(ge=0)]
    """Speed of the pantographs; 0: there are none."""
    wires: list[MovingWire]
    dropper_m: list[FiniteNumber]
    slack: CodedField | None
    """1 for a slack dropper at these positions, else 0; null: no dropper."""
    pantographs: list[MovingPantograph]
    error_mm: FiniteNumber | None
    """Largest difference of the coded rises, joined by straight lines along the wires, from the simulated ones; null:
    the rises have no scale."""

    @model_validator(mode="after")
    def _equal_frames(self) -> Self:
        fields = [wire.rise_mm for wire in self.wires]
        fields += [field for one in self.pantographs for field in (one.height_mm, one.force_N)]
        fields += [] if self.slack is None else [self.slack]
        if len({field.frames for field in fields}) != 1:
            raise ValueError("the fields of the moving picture have different numbers of frames")
        if self.slack is not None:
            check_lengths(self, self.dropper_m, [0.0] * self.slack.columns)
        return self


class LineScene(ResultsPart):
    """Moving pictures of one line: a reader chooses one (mass drops, mode shapes), or all move over each other."""

    id: str
    """Name of the line or of its record."""
    label: str
    """Quantity and unit of the rises at the points with the symbol `sensor`."""
    line_shape: LineShape
    names: Annotated[list[str], Field(min_length=1)]
    motions: list[PassageMotion]
    """One picture for each name."""
    speed: Annotated[FiniteNumber, Field(gt=0)]
    """Speed at the start, over that of the motion."""
    gain: Annotated[FiniteNumber, Field(gt=0)]
    """Enlargement of the motion over the heights at the start."""
    together: bool = False
    """Passages that are compared: the first pantograph of each is at the place of that of the first picture."""

    @model_validator(mode="after")
    def _named_motions(self) -> Self:
        if len(self.names) != len(self.motions):
            raise ValueError("every moving picture needs a name")
        return self
