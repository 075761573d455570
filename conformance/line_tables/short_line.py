"""Short form of an imported line: named dropper schedules, and values of all supports in one place."""

from typing import Any

from pantocheck.conformance.cases.line_file import LineFile

ALTERNATING = {
    "stagger_contact_wire_m": -1.0,
    "stagger_messenger_m": -1.0,
    "contact_wire_height_m": 1.0,
    "encumbrance_m": 1.0,
}
"""Keys of all supports in the table `geometry`, and the factor from one support to the next."""


def shorten_line(line: dict[str, Any], base: LineFile) -> dict[str, Any]:
    """Shorten a line without a change of its meaning.

    Args:
        line: Content of a line file with all values of every span and support.
        base: Line with the same tables `droppers`, `steady_arm` and `messenger_support`.

    Returns:
        Content of a line file: equal schedules share a name, a value that all supports share is that of the line, and
        values of arms, messenger supports and droppers that are those of the base are left out.
    """
    geometry = _move_common_values(line["geometry"])
    supports = [_drop_base_values(support, base) for support in geometry.pop("support")]
    common = base.droppers.schedule.model_dump(exclude_none=True)
    schedules: dict[str, dict[str, Any]] = {}
    spans = []
    for span in geometry["span_list"]:
        short, schedule = {"length_m": span["length_m"]}, span.get("droppers")
        if schedule is not None and {key: tuple(values) for key, values in schedule.items()} != common:
            short["droppers"] = _name_schedule(schedule, span["length_m"], schedules)
        spans.append(short)
    geometry["span_list"] = spans
    if schedules:
        geometry["schedule"] = schedules
    if own := [support for support in supports if support.keys() != {"number"}]:
        geometry["support"] = own
    return line | {"geometry": geometry}


def _move_common_values(geometry: dict[str, Any]) -> dict[str, Any]:
    """Geometry with the heights that all supports share, and with staggers that alternate, as values of the line."""
    supports, moved = geometry["support"], {}
    for key, factor in ALTERNATING.items():
        first = supports[0].get(key)
        if first is not None and all(support.get(key) == first * factor ** support["number"] for support in supports):
            moved[key] = first
    short = [{key: value for key, value in support.items() if key not in moved} for support in supports]
    return geometry | moved | {"support": short}


def _drop_base_values(support: dict[str, Any], base: LineFile) -> dict[str, Any]:
    """Support without the values of its arm and messenger support that are those of the base."""
    short: dict[str, Any] = {}
    for key, value in support.items():
        if not isinstance(value, dict):
            short[key] = value
        elif own := {name: item for name, item in value.items() if getattr(getattr(base, key), name) != item}:
            short[key] = own
    return short


def _name_schedule(schedule: dict[str, Any], length: float, schedules: dict[str, dict[str, Any]]) -> str:
    """Name of a schedule by the length of its first span; equal schedules share a name."""
    for name, known in schedules.items():
        if known == schedule:
            return name
    name, count = f"{length:g} m", 1
    while name in schedules:
        count += 1
        name = f"{length:g} m ({count})"
    schedules[name] = schedule
    return name
