"""Shapes of the wires during a passage, which a program delivers beside its record: an HDF5 file of frames.

time_s                          (frames,)
contact_wire_position_m         (points,)            messenger_wire_..., stitch_wire_..., too
contact_wire_rise_m             (frames, points)     rise over the line at rest; NaN: not known
contact_wire_2_position_m       further wires of one kind in the order of their starts
dropper_position_m              (droppers,)          optional
dropper_slack                   (frames, droppers)   1 for a slack dropper, else 0
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage

MOST_SHAPE_VALUES = 8_000_000
"""Largest number of values of a file: 4000 frames of 2000 points."""

LARGEST_RISE_M = 10.0
"""Larger rises follow from a wrong unit."""

POSITION = re.compile(r"((?:contact|messenger|stitch)_wire)(?:_([1-9]\d?))?_position_m")
"""Name of the positions of a wire: its kind, and its number among those of the kind."""

SHAPES_HINT = f"See {DocumentationPage.SYSTEMS}."


@dataclass(frozen=True)
class WireShapes:
    """Frames of a passage."""

    time: RealArray
    """Uniform time axis, (f,) [s]."""
    wires: Mapping[tuple[str, int], tuple[RealArray, RealArray]]
    """Positions (n,) [m] and rises (f, n) [m] of each wire, by kind and number from 1."""
    slack: tuple[RealArray, RealArray] | None
    """Positions of the droppers (d,) [m], and 1 for a slack one, (f, d); None: not delivered."""

    def select(self, frames: slice) -> "WireShapes":
        """Shapes of some frames."""
        slack = None if self.slack is None else (self.slack[0], self.slack[1][frames])
        return WireShapes(
            self.time[frames], {key: (place, rise[frames]) for key, (place, rise) in self.wires.items()}, slack
        )


def read_wire_shapes(path: Path) -> WireShapes:
    """Read the shapes of the wires of a record.

    Raises:
        InputError: The file is damaged, lacks a data set, or its data sets contradict each other.
        MissingPackage: The extra `massdrop` is not installed.
    """
    where = f"shapes '{path.name}'"
    with refuse_missing_package(where):
        from pantocheck.conformance.core.hdf5_table import open_hdf5, read_numbers
    with open_hdf5(path, MOST_SHAPE_VALUES) as file:
        arrays = {str(name): read_numbers(item, f"{where}, data set {str(name)[:80]!r}") for name, item in file.items()}
    time = _select(arrays, "time_s", (None,), where)
    step = np.diff(time)
    if time.size < 2 or not (step > 0).all() or not np.allclose(step, step.mean(), rtol=0.01):
        raise InputError(f"{where}, data set time_s", "the frames are not evenly spaced in time", SHAPES_HINT)
    wires = {}
    for name in arrays:
        if found := POSITION.fullmatch(name):
            wires[found[1], int(found[2] or 1)] = _read_wire(arrays, name.removesuffix("_position_m"), time.size, where)
    if not wires:
        raise InputError(where, "has no wire", "Store contact_wire_position_m and contact_wire_rise_m.")
    slack = None
    if "dropper_position_m" in arrays:
        place = _select(arrays, "dropper_position_m", (None,), where)
        slack = place, np.round(_select(arrays, "dropper_slack", (time.size, place.size), where)).clip(0, 1)
    return WireShapes(time, wires, slack)


def _read_wire(arrays: Mapping[str, RealArray], wire: str, frames: int, where: str) -> tuple[RealArray, RealArray]:
    place = _select(arrays, f"{wire}_position_m", (None,), where)
    if place.size < 2 or (np.diff(place) <= 0).any():
        raise InputError(f"{where}, data set {wire}_position_m", "the positions do not increase", SHAPES_HINT)
    rise = _select(arrays, f"{wire}_rise_m", (frames, place.size), where, gaps=True)
    largest = np.nanmax(np.abs(rise), initial=0.0)
    if largest > LARGEST_RISE_M:
        found = f"found {largest:.3g} m"
        raise InputError(f"{where}, data set {wire}_rise_m", found, "Give the rise over the line at rest in metres.")
    return place, rise


def _select(
    arrays: Mapping[str, RealArray], name: str, shape: tuple[int | None, ...], where: str, *, gaps: bool = False
) -> RealArray:
    """Data set of finite numbers, or of numbers with gaps; None in its shape is any length."""
    place = f"{where}, data set {name}"
    if name not in arrays:
        raise InputError(place, "is missing", SHAPES_HINT)
    array = arrays[name]
    expected = tuple(size if size is not None else got for size, got in zip(shape, array.shape, strict=False))
    if array.shape != expected or array.ndim != len(shape) or not array.size:
        raise InputError(place, f"has the shape {array.shape}, expected {shape}".replace("None", "any"), SHAPES_HINT)
    if not (~np.isinf(array) if gaps else np.isfinite(array)).all():
        raise InputError(place, "has a value that is not finite", SHAPES_HINT)
    return array
