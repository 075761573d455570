"""Opening of both kinds of record, samples with a sidecar and summaries, by the key `schema` of the TOML file."""

from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model, read_toml
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary

RECORD_SCHEMAS: dict[str, type[RecordSidecar] | type[RecordSummary]] = {
    "pantocheck.record/1": RecordSidecar,
    "pantocheck.summary/1": RecordSummary,
}


def open_record(path: Path) -> RecordSidecar | RecordSummary:
    """Read the TOML file of a record of either kind; the path may also be that of the table.

    Raises
    ------
    InputError
        It cannot be read, does not fit its model, or is of neither kind.
    """
    path = path if path.suffix == ".toml" else path.with_suffix(".toml")
    schema = read_toml(path, "record").get("schema")
    model = RECORD_SCHEMAS.get(schema) if isinstance(schema, str) else None
    if model is None:
        expected = " or ".join(f'"{name}"' for name in RECORD_SCHEMAS)
        raise InputError(
            f"record '{path.name}', key schema",
            "missing" if schema is None else f"found {str(schema)[:60]!r}",
            f"Write schema = {expected}.",
        )
    return read_model(path, model, "sidecar" if model is RecordSidecar else "summary record")
