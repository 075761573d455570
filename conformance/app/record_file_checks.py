"""Checks of records of any kind: their tables with the sidecars."""

from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.comparison.static_record import STATIC_SCHEMA, StaticSidecar, read_static_table
from pantocheck.conformance.core.measured_table import CSV, TABLE_SUFFIXES
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.core.workbook_reading import WORKBOOK_SUFFIXES
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_sidecar import DropSidecar
from pantocheck.conformance.grading.assessed_record import find_missing_statement
from pantocheck.conformance.line.support_rows import check_line_table, read_line_tables
from pantocheck.conformance.pantograph.response_record import RESPONSE_SCHEMA, ResponseSidecar, read_response
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.records.column_values import list_sensor_warnings
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_reading import RECORD_SCHEMAS, build_record_error, read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, analysis_section
from pantocheck.conformance.records.source_alignment import align_source, extend_train, list_sensor_faults
from pantocheck.conformance.records.uplift_sensor import refuse_faulty_uplift
from pantocheck.conformance.records.usable_sections import PlacedSamples, place_samples


def _check_record(path: Path) -> str:
    samples, sidecar, table = read_samples(path)
    rows, n = samples.force.shape
    content = f"record: {n} samples of {count_noun(rows, 'pantograph')}"
    unused = f"\n  columns that are not used: {', '.join(samples.ignored[:20])}" if samples.ignored else ""
    warnings = "".join(f"\n  warning: {text}" for text in _warn_of_record(samples, sidecar, table))
    clocks = "".join(f"\n  {text}" for text in _describe_uplift(samples, sidecar, table))
    return f"{content} in {table.name}, {sidecar.speed_km_h:g} km/h{clocks}{unused}{warnings}"


def _describe_uplift(samples: RecordSamples, sidecar: RecordSidecar, table: Path) -> Iterator[str]:
    """State of the clock of each source of uplift, with the numbers of a confirmed one, and faults of the sensors."""
    if samples.uplift is None and not samples.sources.uplift:
        return
    placed = _place(samples, sidecar, table)
    train = extend_train(placed.time, placed.position, sidecar.speed_km_h / 3.6)
    alignments = [align_source(source, train) for source in samples.sources.uplift]
    for alignment in alignments:
        clock, text = alignment.clock, alignment.describe()
        if alignment.state == "confirmed":
            text += f"; offset {clock.offset:.3f} s, uncertainty {clock.uncertainty:.3f} s"
            text += f", drift {1e6 * clock.drift:.0f} ppm" if clock.drift else ""
        yield text
    section = analysis_section(sidecar, placed.position)
    faults = [fault for part in alignments for fault in list_sensor_faults(part, train, section)]
    line = LineSignals(section, placed.samples.support_position, placed.samples.uplift)
    if (fault := refuse_faulty_uplift(line, placed.position).fault) is not None:
        faults.append(fault)
    yield from (f"warning: `assess` skips the uplift: {fault}" for fault in faults)


def _place(samples: RecordSamples, sidecar: RecordSidecar, table: Path) -> PlacedSamples:
    try:
        return place_samples(samples, sidecar)
    except RecordInvalid as error:
        raise build_record_error(table, error) from None


def _warn_of_record(samples: RecordSamples, sidecar: RecordSidecar, table: Path) -> Iterator[str]:
    """Doubts about a sum of sensors, and reasons why `assess` evaluates no quantity, or none of a pantograph."""
    yield from list_sensor_warnings(sidecar.columns, samples.left_out_sensors)
    if (missing := find_missing_statement(samples, sidecar)) is not None:
        yield f"`assess` skips every criterion: {missing}"
    if sidecar.evaluated_m is None:
        return
    begin, end = sidecar.evaluated_m
    position = _place(samples, sidecar, table).position
    for number, (first, last) in enumerate(position[:, [0, -1]], 1):
        if first > begin or last < end:
            yield (
                f"`assess` skips the criteria of pantograph {number}: its record from {first:g} to {last:g} m does not "
                f"cover evaluated_m, {begin:g} to {end:g} m"
            )


def _check_drop_sidecar(path: Path) -> str:
    named = read_model(path, DropSidecar, "sidecar").file
    names = [f"{path.stem}{suffix}" for suffix in TABLE_SUFFIXES] if named is None else [named]
    tables = [table for name in names if (table := path.with_name(name)).is_file()]
    if not tables:
        return "sidecar of a mass-drop record; its table is not beside it"
    return "; ".join(map(_check_drops, tables if named is None else [path]))


def _check_drops(path: Path) -> str:
    records = read_drop_records(path)
    return f"mass-drop record: {count_noun(len(records), 'run')} in {records[0].source}"


def _check_static(path: Path) -> str:
    sidecar = read_model(path.with_suffix(".toml"), StaticSidecar, "sidecar")
    if not path.with_name(sidecar.file).exists():
        return "static sidecar; its table is not beside it"
    record = read_static_table(path)
    return f"static record: {record.position.size} positions with {' and '.join(record.values)} in {record.source}"


def _check_response(path: Path) -> str:
    sidecar = read_model(path.with_suffix(".toml"), ResponseSidecar, "sidecar")
    if not path.with_name(sidecar.file).exists():
        return "response sidecar; its table is not beside it"
    record = read_response(path)
    low, high = record.frequency[[0, -1]]
    kind = record.sidecar.kind.replace("_", " ")
    return f"response record: {kind} at {record.frequency.size} frequencies, {low:g} to {high:g} Hz, in {record.source}"


def check_table(path: Path) -> str:
    """Summary of a valid table, by the schema of its sidecar; without one, a line table or a mass-drop record."""
    sidecar = path.with_suffix(".toml")
    schema = read_toml(sidecar, "sidecar").get("schema") if sidecar.is_file() else None
    if schema == STATIC_SCHEMA:
        return _check_static(sidecar)
    if schema == RESPONSE_SCHEMA:
        return _check_response(sidecar)
    may_be_line = not sidecar.is_file() and path.suffix.lower() in (*CSV.suffixes, *WORKBOOK_SUFFIXES)
    if may_be_line and (tables := read_line_tables(path)):
        return "; ".join(map(check_line_table, tables))
    return _check_record(sidecar) if schema in RECORD_SCHEMAS else _check_drops(path)


RECORD_FILE_CHECKS = {
    "record": _check_record,
    "mass-drop": _check_drop_sidecar,
    "static": _check_static,
    "response": _check_response,
}
"""Checks of sidecars by their kind, as in `model_file_checks`."""
