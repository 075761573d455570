"""TDMS records (LabVIEW), with a sidecar; needs the extra `tdms`."""

import struct
from pathlib import Path

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

TDMS_DAMAGE = (ValueError, KeyError, TypeError, EOFError, OSError, IndexError, NotImplementedError, struct.error)
"""What nptdms raises for files that are damaged."""


def read_tdms_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """The one run of a TDMS file, its channels in the order of the file; errors as in `read_records`."""
    del sidecar  # the assembly compares the two
    source = path.name
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise InputError(
            source, "needs the package nptdms, which is not installed", "Install it: pip install 'pantocheck[tdms]'"
        ) from None
    try:
        channels = [channel for group in TdmsFile.read(path).groups() for channel in group.channels()]
        vectors = [np.asarray(channel[:], dtype=np.float64) for channel in channels]
    except TDMS_DAMAGE as error:
        raise InputError(source, f"is damaged or not TDMS ({str(error)[:100]})", "Export it again.") from None
    kept = [(channel, vector) for channel, vector in zip(channels, vectors, strict=True) if vector.size]
    if not kept:
        raise InputError(source, "holds no samples", "Export the record again.")
    if len({vector.size for _, vector in kept}) > 1:
        raise InputError(source, "its channels differ in length", "The channels of a record must be sampled together.")
    steps = {channel.properties.get("wf_increment") for channel, _ in kept}
    if len(steps) > 1:
        raise InputError(
            source, "its channels differ in sampling interval", "The channels of a record must be sampled together."
        )
    (step,) = steps
    columns = tuple(DropColumn(channel.name, _unit(channel.properties.get("unit_string"))) for channel, _ in kept)
    rate = 1 / float(step) if step else None
    return [DropColumns(np.column_stack([vector for _, vector in kept]), columns, rate=rate)]


def _unit(text: object) -> str | None:
    return str(text) if text else None
