"""Writing of mass-drop records as universal files, one data set 58 per channel, with a sidecar."""

from pathlib import Path
from typing import Any, Literal

import pyuff

from pantocheck.conformance.core.uff_table import DATA_TYPES, encode_identification_line, write_data_sets
from pantocheck.conformance.core.units import SI_UNITS
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_sidecar


def write_drop_uff(record: DropRecord, path: Path, form: Literal["ascii", "binary"] = "binary") -> None:
    """Write a record as universal file, with a sidecar beside it.

    The format has no fields for wire, position, mass and planned release; they stand in its identification lines and in
    the sidecar.

    Args:
        record: One run.
        path: The file.
        form: Form of the numbers; ASCII numbers have twelve digits.

    Raises:
        InputError: A file cannot be written.
    """
    sets = [_build_data_set(record, c, form) for c in range(len(record.channels))]
    write_drop_sidecar(record, path)
    write_data_sets(path, sets)


def _build_data_set(record: DropRecord, c: int, form: Literal["ascii", "binary"]) -> dict[str, Any]:
    """Data set 58 of a channel; fields for other kinds of data are 0 or NONE."""
    channel = record.channels[c]
    data_set = pyuff.prepare_58(
        binary=int(form == "binary"),
        func_type=1,
        rsp_node=channel.sensor,
        rsp_dir="xyz".index(channel.axis) + 1,
        ref_node=0,
        ref_dir=0,
        ord_data_type=4,
        num_pts=record.signals.shape[0],
        data=record.signals[:, c].copy(),
        x=record.time,
        abscissa_spacing=1,
        abscissa_min=0.0,
        abscissa_inc=1 / record.rate,
        abscissa_spec_data_type=17,
        abscissa_axis_units_lab="s",
        ordinate_spec_data_type=DATA_TYPES[record.quantity],
        ordinate_axis_units_lab=SI_UNITS[record.quantity],
        orddenom_spec_data_type=0,
        orddenom_axis_units_lab="NONE",
        z_axis_spec_data_type=0,
        z_axis_axis_units_lab="NONE",
        id1=encode_identification_line(record.name),
        id2=encode_identification_line(_format_drop(record.drop)),
        id3=encode_identification_line(_format_channel(channel)),
        id4=record.quantity,
        id5="NONE",
    )
    return dict(data_set)


def _format_drop(drop: DropDescription) -> str:
    """Identification line of the mass drop; empty unless the drop is fully known."""
    if drop.mass is None or drop.position is None or not drop.wire:
        return ""
    trigger = "" if drop.trigger_nominal is None else f", trigger at {drop.trigger_nominal:g} s"
    return f"{drop.mass:g} kg on {drop.wire} at {drop.position:g} m{trigger}"


def _format_channel(channel: DropChannel) -> str:
    """Identification line of a channel; empty if the name is not possible there: the sidecar then holds it alone."""
    if channel.position is None or not channel.wire or " " in channel.name or not channel.name.isascii():
        return ""
    return f"{channel.name} {channel.wire} at {channel.position:g} m dir +{channel.axis}"
