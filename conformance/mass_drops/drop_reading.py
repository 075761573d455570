"""Reading of mass-drop records in any format of `input_files.table_formats`."""

from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.input_files.table_formats import read_tables
from pantocheck.conformance.mass_drops.drop_assembly import assemble_drop_record
from pantocheck.conformance.mass_drops.drop_record import DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import read_drop_sidecar

LARGEST_DROP = 30_000_000
"""Largest number of values in a record: 20 channels at 1 kHz for 25 minutes. Reading them takes about 1 GB."""


def read_drop_records(path: Path) -> tuple[DropRecord, ...]:
    """Read all runs of a file.

    Args:
        path: File in one of the formats of `TABLE_FORMATS`; its sidecar has the same stem and the suffix .toml.

    Returns:
        One record per run.

    Raises:
        InputError: The file cannot be read, is damaged, or does not describe its channels.
    """
    sidecar = read_drop_sidecar(path)
    names, layout = (sidecar.channel_names, sidecar.table) if sidecar else ((), None)
    tables = read_tables(path, names, LARGEST_DROP, layout=layout)
    file = str(path.resolve())
    return tuple(replace(assemble_drop_record(table.separate_time(), sidecar), file=file) for table in tables)
