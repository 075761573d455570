"""Heights of the contact wire from the unloaded lengths of the droppers of an imported line."""

from typing import Any

import numpy as np

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import SimulationError
from pantocheck.model.statics.dropper_lengths import hang_on_droppers

LENGTH_ELEMENT_M = 0.25
"""Element length for the heights [m]; the lines of the library have errors of 0.1 mm with it, of 2 mm with 1 m."""

PASSES = 2
"""Passes of the search: the masses of droppers follow from the lengths that the heights give."""

HEIGHT_DIGITS = 6
"""Decimals of the heights [m]: micrometres, far below the error of the elements."""


def hang_line_on_droppers(tree: dict[str, Any], where: str) -> dict[str, Any]:
    """Replace the pre-sags of a line by the heights at which its droppers have their unloaded lengths.

    Args:
        tree: Content of a line file with listed spans; every span has its own droppers with `length_m`.
        where: Name of the table of droppers in messages.

    Returns:
        The same line with `contact_wire_height_m` at every dropper.

    Raises:
        InputError: The line has several tension sections, or no state at rest with these lengths.
    """
    for _ in range(PASSES):
        tree = _set_heights(tree, _find_heights(LineFile.model_validate(tree), where))
    return tree


def _find_heights(line: LineFile, where: str) -> list[list[float]]:
    """Heights of the contact wire at the droppers of every span; of parallel wires, their mean."""
    if len(line.section_places) > 1:
        raise InputError(where, "the line has several tension sections", "Give presag_m or contact_wire_height_m.")
    lengths = [length for schedule in line.dropper_schedules for length in schedule.length_m or ()]
    wires = line.contact_wire.number
    try:
        catenary = build_catenary(line.without_variation)
        hanging = hang_on_droppers(catenary, np.repeat(lengths, wires), LENGTH_ELEMENT_M)
    except SimulationError as error:
        hint = "Check the lengths: they are those of the droppers without load, from wire to wire."
        raise InputError(f"{where}, column 'length_m'", str(error), hint) from None
    heights = np.reshape([dropper.contact_wire_height or 0.0 for dropper in hanging.droppers], (-1, wires)).mean(axis=1)
    counts = [len(schedule.x_m) for schedule in line.dropper_schedules]
    return [part.tolist() for part in np.split(np.round(heights, HEIGHT_DIGITS), np.cumsum(counts)[:-1])]


def _set_heights(tree: dict[str, Any], heights: list[list[float]]) -> dict[str, Any]:
    """Line with heights of the contact wire at its droppers."""
    spans = [
        span | {"droppers": span["droppers"] | {"contact_wire_height_m": part}}
        for span, part in zip(tree["geometry"]["span_list"], heights, strict=True)
    ]
    return tree | {"geometry": tree["geometry"] | {"span_list": spans}}
