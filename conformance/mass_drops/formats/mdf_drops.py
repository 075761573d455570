"""MDF 4 records (ASAM), with a sidecar that names the channels; needs the extra `mdf`."""

from pathlib import Path

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

SAME_TIME = 1e-6  # between the samples of two channels; a hundredth of an interval at 10 kHz [s]


def read_mdf_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """The one run of an MDF file; errors as in `read_records`."""
    source = path.name
    try:
        from asammdf import MDF
        from asammdf.blocks.utils import MdfException
    except ImportError:
        raise InputError(
            source, "needs the package asammdf, which is not installed", "Install it: pip install 'pantocheck[mdf]'"
        ) from None
    if sidecar is None:
        raise InputError(source, "has no sidecar", "Name its channels in a TOML file of the same name beside it.")
    names = [channel.name for channel in sorted(sidecar.channel, key=lambda one: one.column)]
    try:
        with MDF(path) as file:
            missing = [name for name in names if name not in file.channels_db]
            if missing:
                raise InputError(
                    source,
                    f"channel '{missing[0]}' of the sidecar is missing",
                    f"The file holds: {', '.join(sorted(file.channels_db)[:12])}",
                )
            signals = [file.get(name) for name in names]
    except (MdfException, ValueError, KeyError, TypeError, OSError, IndexError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(source, f"is damaged or not MDF ({str(error)[:100]})", "Export it again.") from None
    if len({signal.samples.size for signal in signals}) > 1:
        raise InputError(source, "its channels differ in length", "The channels of a record must be sampled together.")
    time = np.asarray(signals[0].timestamps, dtype=np.float64)
    if any(not np.allclose(signal.timestamps, time, rtol=0, atol=SAME_TIME) for signal in signals[1:]):
        raise InputError(
            source, "its channels differ in sampling interval", "The channels of a record must be sampled together."
        )
    values = np.column_stack([np.asarray(signal.samples, dtype=np.float64) for signal in signals])
    columns = tuple(DropColumn(signal.name, str(signal.unit) or None) for signal in signals)
    return [DropColumns(values, columns, time=time)]
