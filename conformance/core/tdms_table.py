"""TDMS tables (LabVIEW), with a sidecar; needs the extra `tdms`."""

from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import (
    SAMPLED_TOGETHER,
    ChannelNames,
    EveryRate,
    MeasuredTable,
    SampledChannel,
    TableColumn,
    convert_damage_errors,
    group_by_sampling,
    stack_channels,
)


def read_tdms_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read the run of a TDMS file, channels in the order of the file; arguments and errors as in `Reader`.

    `drop_sidecar` compares the names of the columns with the sidecar.
    """
    from nptdms import TdmsFile

    where = f"record '{path.name}'"
    with open_file(path, where, MAX_FILE_BYTES) as file, convert_damage_errors(where, "TDMS"):
        stated = sum(len(channel) for group in TdmsFile.read_metadata(file).groups() for channel in group.channels())
        if stated > min(largest, path.stat().st_size):  # a sample has at least one byte
            hint = f"At most {largest} samples are accepted, and not more samples than the file has bytes."
            raise InputError(where, f"states {stated} samples", hint)
        file.seek(0)
        channels = [channel for group in TdmsFile.read(file).groups() for channel in group.channels()]
        vectors = [np.asarray(channel[:], dtype=np.float64) for channel in channels]
    kept = [(channel, vector) for channel, vector in zip(channels, vectors, strict=True) if vector.size]
    if not kept:
        raise InputError(where, "holds no samples", "Export the record again.")
    if isinstance(names, EveryRate):
        found = (
            SampledChannel(_describe(channel), vector, channel.properties.get("wf_increment"))
            for channel, vector in kept
        )
        return group_by_sampling(path.name, found, largest)
    values = stack_channels([vector for _, vector in kept], where, largest)
    steps = {channel.properties.get("wf_increment") for channel, _ in kept}
    if len(steps) > 1:
        raise InputError(where, "has channels with different sampling intervals", SAMPLED_TOGETHER)
    (step,) = steps
    columns = tuple(_describe(channel) for channel, _ in kept)
    return [MeasuredTable(path.name, values, columns, rate=1 / float(step) if step else None)]


def _describe(channel: Any) -> TableColumn:
    """Name and unit of a channel."""
    return TableColumn(channel.name, unit=str(channel.properties.get("unit_string") or "") or None)
