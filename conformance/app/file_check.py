"""Check of input files of any kind: every problem of a file is reported."""

import os
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, TypeAdapter

from pantocheck.conformance.app.schemas import READ_FORMATS, WRITTEN_FORMATS
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.cases.lift_force import resolve_rule
from pantocheck.conformance.cases.limits import Limit, LimitsFile
from pantocheck.conformance.comparison.static_record import STATIC_SCHEMA, read_static_table
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.json_file import read_json, validate_json
from pantocheck.conformance.core.measured_table import CSV, TABLE_FORMATS
from pantocheck.conformance.core.sourced_table import NO_SOURCE
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.dossier.dossier_reading import read_dossier
from pantocheck.conformance.dossier.validation import check_documents
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_sidecar import DropSidecar
from pantocheck.conformance.grading.assessed_record import find_missing_statement
from pantocheck.conformance.grading.validity_warnings import speed_warnings
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.support_rows import check_line_table, read_line_table
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import RESPONSE_SCHEMA, ResponseSidecar, read_response
from pantocheck.conformance.records.column_values import list_sensor_warnings
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_reading import RECORD_SCHEMAS, build_record_error, read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples
from pantocheck.conformance.records.usable_sections import place_samples
from pantocheck.conformance.results.results_reading import MAX_RESULTS_BYTES
from pantocheck.model import discretise
from pantocheck.model.description.failures import ImpossibleDropper, SimulationError

LARGEST_REST_ELEMENT_M = 2.0
"""Largest element for the line at rest, whose shape hardly depends on it [m]."""

TABLE_SUFFIXES = tuple(suffix for table_format in TABLE_FORMATS for suffix in table_format.suffixes)


def check_input_file(path: Path, kind: str | None = None) -> str:
    """Check a TOML file, JSON file or table of a record, with the files that it names.

    Args:
        path: The file; a folder stands for one without input files.
        kind: Kind of a TOML file, a key of `READ_FORMATS`; None: it is recognised by its keys.

    Returns:
        Kind and size of the valid content, and a line for each warning.

    Raises:
        InputError: The file is invalid; the error lists all problems.
    """
    if path.is_dir():
        raise InputError(
            f"folder '{path}'",
            "there is no input file in it",
            "Give a folder with TOML files, or with tables of supports and droppers.",
        )
    suffix = path.suffix.lower()
    if suffix in TABLE_SUFFIXES:
        return _check_table(path)
    if suffix == ".json":
        return _check_json(path)
    where = f"file '{path.name}'"
    if kind is None:
        kind = recognise_toml(read_toml(path, "file"), where)
    elif kind not in READ_FORMATS:
        raise InputError("option --kind", f"there is no kind {kind!r}", suggest_names(kind, list(READ_FORMATS)))
    if kind in _CHECKS:
        return _CHECKS[kind](path)
    read_model(path, READ_FORMATS[kind], kind)
    return f"{kind} file"


def _check_case(path: Path) -> str:
    case = load_case(path)
    _check_rest(case.line, f"case '{path.name}', line {case.line.title!r}")
    speed = "line at rest" if case.file.speed_km_h is None else f"{case.file.speed_km_h:g} km/h"
    pantographs = [count_noun(len(case.pantographs), "pantograph")] if case.pantographs else []
    speeds = [] if case.is_static else speed_warnings(case)
    warnings = [f"\n  warning: {text}" for text in (*speeds, *_warn_of_limits(case.file.limit))]
    description = f"case {case.id}: {', '.join([speed, *pantographs])}; line: {_describe_line(case.line)}"
    return "".join([description, *warnings])


def _check_limits(path: Path) -> str:
    limits = read_model(path, LimitsFile, "limits").limit
    return "".join(["limits file", *(f"\n  warning: {text}" for text in _warn_of_limits(limits))])


def _warn_of_limits(limits: Iterable[Limit]) -> Iterator[str]:
    """Limits without a source, which decide no verdict."""
    for limit in limits:
        if limit.source == NO_SOURCE:
            yield f'the limit of {limit.quantity} does not count. Give it trust, e.g. "primary", and source'


def _check_line(path: Path) -> str:
    line = read_model(path, LineFile, "line")
    _check_rest(line, f"line '{path.name}'")
    return f"line: {_describe_line(line)}"


def _check_pantograph(path: Path) -> str:
    resolve_rule(read_model(path, PantographFile, "pantograph"), f"pantograph '{path.name}'")
    return "pantograph file"


def _check_rest(line: LineFile, where: str) -> None:
    """Refuse a line without a static equilibrium."""
    try:
        discretise(build_catenary(line), LARGEST_REST_ELEMENT_M)
    except SimulationError as error:
        place = _name_dropper(line, error.position) if isinstance(error, ImpossibleDropper) else ""
        hint = (
            "Check encumbrance, tensions, masses, pre-sag and the positions of the droppers; check that the heights "
            "contact_wire_height_m of supports and droppers count from the same datum."
        )
        raise InputError(where, f"is impossible at rest: {place}{error}", hint) from None


def _name_dropper(line: LineFile, position: float) -> str:
    """Numbers of the span and of its dropper nearest to a position [m]."""
    number, _ = line.geometry.spans_of_section(position, position)
    dropper = int(np.argmin(np.abs(line.layout.spans[number - 1].dropper_position - position))) + 1
    return f"span {number}, dropper {dropper}: "


def _describe_line(line: LineFile) -> str:
    return f"{line.geometry.spans} spans, {line.geometry.length:g} m"


def _check_record(path: Path) -> str:
    samples, sidecar, table = read_samples(path)
    rows, n = samples.force.shape
    content = f"record: {n} samples of {count_noun(rows, 'pantograph')}"
    unused = f"\n  columns that are not used: {', '.join(samples.ignored[:20])}" if samples.ignored else ""
    warnings = "".join(f"\n  warning: {text}" for text in _warn_of_record(samples, sidecar, table))
    return f"{content} in {table.name}, {sidecar.speed_km_h:g} km/h{unused}{warnings}"


def _warn_of_record(samples: RecordSamples, sidecar: RecordSidecar, table: Path) -> Iterator[str]:
    """Doubts about a sum of sensors, and reasons why `assess` evaluates no quantity, or none of a pantograph."""
    yield from list_sensor_warnings(sidecar.columns, samples.left_out_sensors)
    if (missing := find_missing_statement(samples, sidecar)) is not None:
        yield f"`assess` skips every criterion: {missing}"
    if sidecar.evaluated_m is None:
        return
    begin, end = sidecar.evaluated_m
    try:
        position = place_samples(samples, sidecar).position
    except RecordInvalid as error:
        raise build_record_error(table, error) from None
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


def _check_table(path: Path) -> str:
    sidecar = path.with_suffix(".toml")
    schema = read_toml(sidecar, "sidecar").get("schema") if sidecar.is_file() else None
    if schema == STATIC_SCHEMA:
        return _check_static(sidecar)
    if schema == RESPONSE_SCHEMA:
        return _check_response(sidecar)
    if not sidecar.is_file() and path.suffix.lower() in CSV.suffixes and (table := read_line_table(path)) is not None:
        return check_line_table(table)
    return _check_record(sidecar) if schema in RECORD_SCHEMAS else _check_drops(path)


def _check_json(path: Path) -> str:
    where = f"file '{path.name}'"
    content = read_json(path, "file", MAX_RESULTS_BYTES)
    kind = recognise_json(content, where)
    validate_json(content, TypeAdapter(WRITTEN_FORMATS[kind]), where, f"See `pantocheck schema {kind}`.")
    return f"{kind} file"


def _check_dossier(path: Path) -> str:
    dossier = read_dossier(path)
    lines, cases = count_noun(len(dossier.lines), "line"), count_noun(len(dossier.cases), "reference model")
    pairs, tables = count_noun(len(dossier.file.pair), "pair"), count_noun(check_documents(dossier), "table")
    return f"dossier: {lines}, {cases}, {pairs} of runs, {tables}"


_CHECKS: dict[str, Callable[[Path], str]] = {
    "case": _check_case,
    "dossier": _check_dossier,
    "line": _check_line,
    "limits": _check_limits,
    "pantograph": _check_pantograph,
    "record": _check_record,
    "mass-drop": _check_drop_sidecar,
    "static": _check_static,
    "response": _check_response,
}


# Kind of an input file, recognised by its keys.
def recognise_toml(tree: Mapping[str, Any], where: str) -> str:
    """Kind of a TOML file, a key of `READ_FORMATS`: the format with the fewest unknown and missing keys.

    Raises:
        InputError: No format has a key of the file, or several formats fit equally well.
    """
    ranks = {kind: rank for kind, model in READ_FORMATS.items() if (rank := _rank(model, tree)) is not None}
    best = [kind for kind, rank in ranks.items() if rank == min(ranks.values())]
    if len(best) == 1:
        return best[0]
    found = f"may be of the kind {' or '.join(best)}" if best else "has no key of any kind of input file"
    raise InputError(where, found, f"Give the option --kind with one of {', '.join(READ_FORMATS)}.")


def recognise_json(content: Any, where: str) -> str:
    """Kind of a JSON file by its schema; a list contains modes."""
    if isinstance(content, list):
        return "modes"
    stated = content.get("schema") if isinstance(content, dict) else None
    known = {name: kind for kind, model in WRITTEN_FORMATS.items() for name in _list_schemas(model) if name}
    if not isinstance(stated, str) or stated not in known:
        found = "no schema is stated" if stated is None else f"found {str(stated)[:60]!r}"
        raise InputError(f"{where}, key schema", found, f"Known are {', '.join(known)}.")
    return known[stated]


def list_keys(model: type[BaseModel]) -> set[str]:
    """Keys of a table."""
    return {field.alias or name for name, field in model.model_fields.items()}


def _rank(model: type[BaseModel], tree: Mapping[str, Any]) -> tuple[bool, int, int] | None:
    """Other schema, number of unknown keys and number of missing keys; None if no key is known."""
    known = list_keys(model)
    if not known & tree.keys():
        return None
    required = {field.alias or name for name, field in model.model_fields.items() if field.is_required()}
    return tree.get("schema") not in _list_schemas(model), len(tree.keys() - known), len(required - tree.keys())


def _list_schemas(model: type[BaseModel]) -> tuple[Any, ...]:
    """Values of the key `schema`; None if the format has no such key."""
    field = model.model_fields.get("schema_")
    return (None,) if field is None else typing.get_args(field.annotation)


# Search of a folder for input files.
SKIPPED_FOLDERS = ("build", "node_modules", "__pycache__")
"""Names of folders with files of tools."""

ENVIRONMENT_FILE = "pyvenv.cfg"
"""File in the folder of a virtual environment."""


def list_input_files(folder: Path) -> Iterator[Path]:
    """List the input files of a folder and of the folders below it.

    Hidden folders, virtual environments and `SKIPPED_FOLDERS` below the folder are left out.

    Yields:
        TOML file with a key of any kind of input file, or that cannot be read; table of supports or droppers. A sidecar
        stands for its table.
    """
    for parent, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not _is_skipped(Path(parent, name)))
        yield from (path for name in sorted(names) if _is_input(path := Path(parent, name)))


def _is_skipped(folder: Path) -> bool:
    return folder.name.startswith(".") or folder.name in SKIPPED_FOLDERS or (folder / ENVIRONMENT_FILE).is_file()


def _is_input(path: Path) -> bool:
    suffix = path.suffix.lower()
    if suffix in CSV.suffixes:
        return not path.with_suffix(".toml").is_file() and read_line_table(path) is not None
    if suffix != ".toml":
        return False
    try:
        return not read_toml(path, "file").keys().isdisjoint(set().union(*map(list_keys, READ_FORMATS.values())))
    except InputError:
        return True
