"""MDF 4 tables (ASAM), with a sidecar that names the channels; needs the extra `mdf`."""

import gc
import logging
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import (
    SAMPLED_TOGETHER,
    ChannelNames,
    EveryChannel,
    EveryRate,
    MeasuredTable,
    SampledChannel,
    TableColumn,
    convert_damage_errors,
    group_by_sampling,
    stack_channels,
)

SPARE_BYTES = 2**20
"""Size of a group beside its numbers [bytes]."""
SAME_TIME = 1e-6
"""Tolerance between the times of two channels [s]; a hundredth of an interval at 10 kHz."""


def read_mdf_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read the run of an MDF file; arguments and errors as in `measured_table.Reader`."""
    from asammdf import MDF
    from asammdf.blocks.utils import MdfException

    where = f"record '{path.name}'"
    if not names:
        raise InputError(
            where, "has no sidecar", f"Describe its channels in {path.with_suffix('.toml').name} in the same folder."
        )
    with (
        open_file(path, where, MAX_FILE_BYTES) as content,
        convert_damage_errors(where, "MDF", MdfException),
        _silence_library(),
        MDF(content) as file,
    ):
        if isinstance(names, EveryRate):
            _check_sizes(file, set(range(len(file.groups))), largest, where)
            return group_by_sampling(path.name, _list_signals(file), largest)
        names = _list_channels(file, largest, where) if isinstance(names, EveryChannel) else names
        missing = [name for name in names if name not in file.channels_db]
        if missing:
            raise InputError(
                where,
                f"has no channel '{missing[0]}', which the sidecar names",
                f"The file holds the channels {', '.join(sorted(file.channels_db)[:12])}.",
            )
        places = [file.channels_db[name][0] for name in names]
        if not places:
            raise InputError(where, "holds no channel of numbers", "Export the record again.")
        stated = sum(file.groups[group].channel_group.cycles_nr for group, _ in places)
        if stated > largest:
            raise InputError(where, f"states {stated} samples", f"At most {largest} samples are accepted.")
        _check_sizes(file, {group for group, _ in places}, largest, where)
        signals = [file.get(name) for name in names]
    values = stack_channels([np.asarray(signal.samples, dtype=np.float64) for signal in signals], where, largest)
    time = np.asarray(signals[0].timestamps, dtype=np.float64)
    if any(not np.allclose(signal.timestamps, time, rtol=0, atol=SAME_TIME) for signal in signals[1:]):
        raise InputError(where, "has channels with different sampling times", SAMPLED_TOGETHER)
    columns = tuple(TableColumn(signal.name, unit=str(signal.unit) or None) for signal in signals)
    return [MeasuredTable(path.name, values, columns, time=time)]


def _list_signals(file: Any) -> Iterator[SampledChannel]:
    """Every channel of numbers, with the times of its group."""
    for number, group in enumerate(file.groups):
        for index in range(len(group.channels)):
            if index != file.masters_db.get(number) and group.channel_group.cycles_nr:
                signal = file.get(group=number, index=index)
                if np.asarray(signal.samples).dtype.kind in "fiu":
                    values, time = (np.asarray(part, dtype=np.float64) for part in (signal.samples, signal.timestamps))
                    yield SampledChannel(TableColumn(signal.name, unit=str(signal.unit) or None), values, None, time)


def _list_channels(file: Any, largest: int, where: str) -> tuple[str, ...]:
    """Names of the channels of numbers in the group with the most samples, without its time channel."""
    groups = [(int(group.channel_group.cycles_nr), number) for number, group in enumerate(file.groups)]
    samples, number = max(groups, default=(0, 0))
    if not samples:
        raise InputError(where, "holds no samples", "Export the record again.")
    _check_sizes(file, {number}, largest, where)
    channels = file.groups[number].channels
    if samples * len(channels) > largest:
        raise InputError(where, f"states {samples * len(channels)} samples", f"At most {largest} samples are accepted.")
    masters = {file.masters_db.get(number)}
    return tuple(
        channel.name
        for index, channel in enumerate(channels)
        if index not in masters and np.asarray(file.get(group=number, index=index).samples).dtype.kind in "fiu"
    )


def _check_sizes(file: Any, groups: set[int], largest: int, where: str) -> None:
    """Refuse groups whose records hold more bytes than the accepted numbers: the reading library allocates all."""
    for number in groups:
        group = file.groups[number].channel_group
        record = int(group.samples_byte_nr) + int(group.invalidation_bytes_nr)
        if record * int(group.cycles_nr) > 8 * largest + SPARE_BYTES:
            found = f"states {group.cycles_nr} records of {record} bytes"
            raise InputError(where, found, f"At most {8 * largest + SPARE_BYTES} bytes are accepted.")


@contextmanager
def _silence_library() -> Iterator[None]:
    """Suppress the log of the library, and the tracebacks that its half-built objects print when they are deleted."""
    logger, hook = logging.getLogger("asammdf"), sys.unraisablehook
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    sys.unraisablehook = lambda _: None
    try:
        yield
    except Exception as error:
        traceback.clear_frames(error.__traceback__)
        gc.collect()  # Deletes these objects now.
        raise
    finally:
        logger.setLevel(level)
        sys.unraisablehook = hook
