"""Section on the records of an identification: places of sensors and masses, part of each record in the fit."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.drop_layout_figure import draw_drop_layout
from pantocheck.conformance.reports.figures.spectrogram_figure import draw_spectrogram
from pantocheck.conformance.reports.page_text import format_plain, format_value


def list_record_blocks(line: dict[str, Any]) -> Iterator[doc.Block]:
    """Schematic and table of the records of one line of identification.json."""
    sensors, masses = _list_sensors(line["records"]), _list_masses(line["records"])
    if line.get("spans_m") and (sensors or masses):
        places = [
            f"{point['label']} on {point['wire'] or 'an unknown wire'} at {format_plain(point['position_m'])} m"
            for point in (*sensors, *masses)
        ]
        figure = doc.Figure(
            draw_drop_layout(line["spans_m"], sensors, masses),
            f"Line with {len(line['spans_m'])} spans: {'; '.join(places)}.",
            "Sensors (squares) and masses (triangles) on the line; heights and droppers are schematic.",
        )
        yield doc.Figures((figure,))
    yield _record_table(line["records"])
    yield doc.Figures((_spectrogram_figure(line["spectrogram"], line["records"][0]),))


def _spectrogram_figure(data: dict[str, Any], record: dict[str, Any]) -> doc.Figure:
    start, end = (record[key] - record["release_s"] for key in ("used_from_s", "used_to_s"))
    last = max(record["length_s"] - record["release_s"], end)
    marks = {"release": 0.0, "start of the linear decay": start, "end of the linear decay": end}
    return doc.Figure(
        draw_spectrogram(data, marks, (-record["release_s"], last)),
        f"Amplitude of {data['channel']} over time and frequency: whole record, and first seconds. The linear decay "
        f"lasts from {format_value(start, 3)} s to {format_value(end)} s after the release.",
        f"{data['record']}: spectrogram of {data['channel']}, left in windows of {data['whole']['window_s']:g} s, "
        f"right in windows of {data['start']['window_s']:g} s. "
        f"Droppers may be slack from the release to the start of the linear decay, for {format_value(start, 3)} s.",
    )


def _list_sensors(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Sensors of all records with known positions; sensors at one place share a label."""
    names: dict[tuple[str, float], dict[str, None]] = {}
    for sensor in (sensor for record in records for sensor in record.get("sensors", ())):
        if sensor["position_m"] is not None:
            names.setdefault((sensor["wire"], sensor["position_m"]), {})[sensor["channel"]] = None
    return [
        {"label": ", ".join(channels), "wire": wire, "position_m": position}
        for (wire, position), channels in names.items()
    ]


def _list_masses(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Masses of all records with known positions; masses at one place share a label."""
    masses: dict[tuple[str, float], dict[str, None]] = {}
    for record in records:
        if record["drop_position_m"] is not None:
            text = "mass" if record["mass_kg"] is None else f"{format_plain(record['mass_kg'])} kg"
            masses.setdefault((record["drop_wire"], record["drop_position_m"]), {})[text] = None
    return [
        {"label": ", ".join(texts), "wire": wire, "position_m": position} for (wire, position), texts in masses.items()
    ]


def _record_table(records: list[dict[str, Any]]) -> doc.Table:
    def drop(record: dict[str, Any]) -> str:
        place = f"{record['drop_wire'] or '?'} at {format_plain(record['drop_position_m'])} m"
        return f"{format_plain(record['mass_kg'])} kg, {place}"

    def analysed(record: dict[str, Any]) -> str:
        start, end = (record[key] - record["release_s"] for key in ("used_from_s", "used_to_s"))
        return f"{format_value(start, 3)}–{format_value(end)} s"

    cells = {
        "Record": lambda record: record["name"],
        "Drop": drop,
        "Recording": lambda record: f"{format_value(record['length_s'])} s at {record['sampling_rate_Hz']:g} Hz",
        "Used after the release": analysed,
        "Channels": lambda record: ", ".join(record["channels"]),
    }
    return doc.make_grid("Records and the part of each that was used", records, cells)
