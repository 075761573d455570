"""Both kinds of record: samples with a sidecar, and a summary. The `schema` key of the TOML file says which it is."""

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
    """Read the TOML file of a record, whichever kind it is; a table may be named in place of its sidecar.

    Raises
    ------
    InputError
        It cannot be read, is wrong, or is of neither kind.
    """
    path = path if path.suffix == ".toml" else path.with_suffix(".toml")
    schema = read_toml(path, "record").get("schema")
    model = RECORD_SCHEMAS.get(schema) if isinstance(schema, str) else None
    if model is None:
        expected = " or ".join(f'"{name}"' for name in RECORD_SCHEMAS)
        raise InputError(
            f"record '{path.name}', key schema",
            "missing" if schema is None else f"found {str(schema)[:60]!r}",
            f"A record says schema = {expected}.",
        )
    return read_model(path, model, "sidecar" if model is RecordSidecar else "summary record")
