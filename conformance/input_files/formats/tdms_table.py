"""TDMS tables (LabVIEW), with a sidecar; needs the extra `tdms`."""

import struct
from pathlib import Path

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn, stack_channels

TDMS_DAMAGE = (ValueError, KeyError, TypeError, EOFError, OSError, IndexError, NotImplementedError, struct.error)
"""Exceptions that nptdms raises for damaged files."""


def read_tdms_table(path: Path, names: tuple[str, ...], largest: int) -> list[MeasuredTable]:
    """Read the run of a TDMS file, channels in the order of the file; arguments and errors as in `Reader`."""
    del names  # the order of the file decides; names are compared with the sidecar later
    from nptdms import TdmsFile

    where = f"record '{path.name}'"
    try:
        channels = [channel for group in TdmsFile.read(path).groups() for channel in group.channels()]
        vectors = [np.asarray(channel[:], dtype=np.float64) for channel in channels]
    except TDMS_DAMAGE as error:
        raise InputError(where, f"is damaged or not TDMS ({str(error)[:100]})", "Export it again.") from None
    kept = [(channel, vector) for channel, vector in zip(channels, vectors, strict=True) if vector.size]
    if not kept:
        raise InputError(where, "holds no samples", "Export the record again.")
    values = stack_channels([vector for _, vector in kept], where, largest)
    steps = {channel.properties.get("wf_increment") for channel, _ in kept}
    if len(steps) > 1:
        raise InputError(
            where, "its channels differ in sampling interval", "The channels of a record must be sampled together."
        )
    (step,) = steps
    columns = tuple(
        TableColumn(channel.name, unit=str(channel.properties.get("unit_string") or "") or None) for channel, _ in kept
    )
    return [MeasuredTable(path.name, values, columns, rate=1 / float(step) if step else None)]
