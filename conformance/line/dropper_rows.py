"""Rows of the table of droppers: the schedule of every span."""

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_columns import DROPPER_KEYS, TypedRow
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import SimulationError
from pantocheck.model.discretisation.dropper_lengths import hang_on_droppers

LengthMeaning = Literal["published", "unloaded"]
"""Meaning of the lengths of droppers: published, for comparison only; without load, from wire to wire."""

SpanRows = dict[int, list[TypedRow]]
"""Rows of the droppers by number of their span, from 1."""


def group_by_span(rows: list[TypedRow], spans: int, where: str, problems: list[InputError]) -> SpanRows:
    """Rows of every span.

    Args:
        rows: Rows of the table.
        spans: Number of spans of the line.
        where: Name of the table in messages.
        problems: List to which every problem is added: a row without its span, a span that does not exist or has no
            row, and a span in which a value is given for some of the droppers only.

    Returns:
        Rows with a position by number of their span, from 1.
    """
    groups: SpanRows = {number: [] for number in range(1, spans + 1)}
    for row in rows:
        number = row.values.get("span")
        if isinstance(number, int) and number in groups:
            groups[number].append(row)
        else:
            place = row.places.get("span", row.place)
            found = "the number of the span is missing" if number is None else f"there is no span {number}"
            problems.append(InputError(place, found, f"The line has spans 1 to {spans}."))
    empty = [str(number) for number, group in groups.items() if not group]
    if empty:
        spans_text = f"span{'s' if len(empty) > 1 else ''} {', '.join(empty[:20])}{', ...' if len(empty) > 20 else ''}"
        problems.append(InputError(where, f"has no row for {spans_text}", "Give the droppers of every span."))
    for number, group in groups.items():
        for key in DROPPER_KEYS:
            missing = [row for row in group if key not in row.values]
            if missing and (key == "x_m" or len(missing) < len(group)):
                problems.extend(
                    InputError(
                        row.places.get(key, row.place),
                        f"{key} is missing",
                        "Give the position."
                        if key == "x_m"
                        else f"Other droppers of span {number} have it: give it for all.",
                    )
                    for row in missing
                )
    return {number: [row for row in group if "x_m" in row.values] for number, group in groups.items()}


def find_height_problems(groups: SpanRows, meaning: LengthMeaning) -> Iterator[InputError]:
    """Spans whose heights are not determined, or determined twice, by the pre-sags, heights and lengths of their rows.

    Args:
        groups: Rows by number of their span.
        meaning: Meaning of the lengths of the droppers.

    Yields:
        The problem of a span, at its first row.
    """
    for number, group in groups.items():
        filled = {key for row in group for key in row.values}
        given = sorted(filled & {"presag_m", "contact_wire_height_m"})
        place = group[0].places.get("length_m", group[0].place) if group else ""
        if meaning == "published" and "length_m" in filled and not given:
            yield InputError(
                place,
                f"span {number} has lengths, but neither pre-sags nor heights",
                "Give presag_m (0 for a level wire) or contact_wire_height_m, or --dropper-lengths unloaded if the "
                "lengths without load determine the heights.",
            )
        if meaning == "unloaded" and group and "length_m" not in filled:
            yield InputError(place, f"span {number} has no lengths", "Give length_m for every dropper.")
        if meaning == "unloaded" and given:
            yield InputError(
                group[0].places[given[0]],
                f"{given[0]} is given, but the lengths determine the heights",
                "Remove this column, or leave out --dropper-lengths unloaded.",
            )


def find_droppers_outside(groups: SpanRows, lengths: Sequence[float | None]) -> Iterator[InputError]:
    """Droppers behind the end of their span. The line file has the same rule, and checks it for valid spans only."""
    for number, group in groups.items():
        length = lengths[number - 1]
        for row in group:
            x = row.number("x_m")
            if x is not None and length is not None and x >= length:
                yield InputError(
                    row.places["x_m"],
                    f"{x:g} m is not inside the span of {length:g} m",
                    f"Give positions between 0 and {length:g} m, from the start of the span.",
                )


def build_schedule(group: list[TypedRow]) -> dict[str, Any]:
    """Schedule of one span as a table of a line file; pre-sags that are all zero are left out."""
    schedule = {key: [row.number(key) for row in group] for key in DROPPER_KEYS}
    filled = {key: values for key, values in schedule.items() if None not in values}
    if not any(filled.get("presag_m", [])) and "contact_wire_height_m" not in filled:
        filled.pop("presag_m", None)
    return filled


def locate_droppers(groups: SpanRows) -> dict[str, str]:
    """Place in the table by key of the line file, for messages."""
    places: dict[str, str] = {}
    for number, group in groups.items():
        table = f"geometry.span_list[{number}].droppers"
        for i, row in enumerate(group, 1):
            places.setdefault(table, row.place)
            for key in DROPPER_KEYS:
                places[f"{table}.{key}[{i}]"] = row.places.get(key, row.place)
                places.setdefault(f"{table}.{key}", row.places.get(key, row.place))
    return places


# Heights of the contact wire from the unloaded lengths of the droppers of an imported line.
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
        found = "dropper lengths need a line with one tension section; this one has several"
        raise InputError(where, found, "Give presag_m or contact_wire_height_m.")
    lengths = [length for schedule in line.dropper_schedules for length in schedule.length_m or ()]
    wires = line.contact_wire.number
    try:
        catenary = build_catenary(line.model_copy(update={"variation": None}))
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
