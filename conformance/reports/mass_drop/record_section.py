"""Section on the records of an identification: places of sensors and masses, part of each record in the fit."""

from collections.abc import Callable, Iterator, Sequence

from pantocheck.conformance.identification.identification_format import IdentifiedLine, IdentifiedRecord, Spectrogram
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.drop_layout_figure import DrawnPlace, draw_drop_layout
from pantocheck.conformance.reports.figures.spectrogram_figure import draw_spectrogram
from pantocheck.conformance.reports.page_text import format_plain, format_value


def list_record_blocks(line: IdentifiedLine) -> Iterator[doc.Block]:
    """Schematic and table of the records of one line of identification.json."""
    sensors, masses = _list_sensors(line.records), _list_masses(line.records)
    if line.spans_m and (sensors or masses):
        places = [
            f"{point.label} on {point.wire or 'an unknown wire'} at {format_plain(point.position_m)} m"
            for point in (*sensors, *masses)
        ]
        figure = doc.Figure(
            draw_drop_layout(line.spans_m, sensors, masses),
            f"Line with {len(line.spans_m)} spans: {'; '.join(places)}.",
            "Sensors (squares) and masses (triangles) on the line; heights and droppers are schematic.",
        )
        yield doc.Figures((figure,))
    yield _record_table(line.records)
    yield doc.Figures((_spectrogram_figure(line.spectrogram, line.records[0]),))


def _spectrogram_figure(data: Spectrogram, record: IdentifiedRecord) -> doc.Figure:
    start, end = (time - record.release_s for time in (record.used_from_s, record.used_to_s))
    last = max(record.length_s - record.release_s, end)
    marks = {"release": 0.0, "start of the linear decay": start, "end of the linear decay": end}
    return doc.Figure(
        draw_spectrogram(data, marks, (-record.release_s, last)),
        f"Amplitude of {data.channel} over time and frequency: whole record, and first seconds. The linear decay "
        f"lasts from {format_value(start, 3)} s to {format_value(end)} s after the release.",
        f"{data.record}: spectrogram of {data.channel}, left in windows of {data.whole.window_s:g} s, "
        f"right in windows of {data.start.window_s:g} s. "
        f"Droppers may be slack from the release to the start of the linear decay, for {format_value(start, 3)} s.",
    )


def _list_sensors(records: Sequence[IdentifiedRecord]) -> list[DrawnPlace]:
    """Sensors of all records with known positions; sensors at one place share a label."""
    names: dict[tuple[str, float], dict[str, None]] = {}
    for sensor in (sensor for record in records for sensor in record.sensors):
        if sensor.position_m is not None:
            names.setdefault((sensor.wire, sensor.position_m), {})[sensor.channel] = None
    return [DrawnPlace(", ".join(channels), wire, position) for (wire, position), channels in names.items()]


def _list_masses(records: Sequence[IdentifiedRecord]) -> list[DrawnPlace]:
    """Masses of all records with known positions; masses at one place share a label."""
    masses: dict[tuple[str, float], dict[str, None]] = {}
    for record in records:
        if record.drop_position_m is not None:
            text = "mass" if record.mass_kg is None else f"{format_plain(record.mass_kg)} kg"
            masses.setdefault((record.drop_wire, record.drop_position_m), {})[text] = None
    return [DrawnPlace(", ".join(texts), wire, position) for (wire, position), texts in masses.items()]


def _record_table(records: Sequence[IdentifiedRecord]) -> doc.Table:
    def drop(record: IdentifiedRecord) -> str:
        place = f"{record.drop_wire or '?'} at {format_plain(record.drop_position_m)} m"
        return f"{format_plain(record.mass_kg)} kg, {place}"

    def analysed(record: IdentifiedRecord) -> str:
        start, end = (time - record.release_s for time in (record.used_from_s, record.used_to_s))
        return f"{format_value(start, 3)}–{format_value(end)} s"

    cells: dict[str, Callable[[IdentifiedRecord], str]] = {
        "Record": lambda record: record.name,
        "Drop": drop,
        "Recording": lambda record: f"{format_value(record.length_s)} s at {record.sampling_rate_Hz:g} Hz",
        "Used after the release": analysed,
        "Channels": lambda record: ", ".join(record.channels),
    }
    return doc.make_grid("Records and the part of each that was used", records, cells)
