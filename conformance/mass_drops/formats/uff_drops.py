"""Universal file format, data set 58 (ASCII) and 58b (binary): one function of time per channel."""

import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_record import DropDescription
from pantocheck.conformance.mass_drops.drop_sidecar import DropChannelTable, DropSidecar

TIME_RESPONSE = 1
DIRECTIONS = {1: "+x", 2: "+y", 3: "+z", -1: "-x", -2: "-y", -3: "-z"}
UNIT_OF_DATA_TYPE = {8: "m", 11: "m/s", 12: "m/s2"}  # specific data types of the format
CHANNEL_LINE = re.compile(r"(?P<name>\S+) (?P<wire>\S+) at (?P<position>[-+.\deE]+) m dir (?P<direction>[-+][xyz])")
DROP_LINE = re.compile(
    r"(?P<mass>[.\deE+]+) kg on (?P<wire>\S+) at (?P<position>[-+.\deE]+) m(?:, trigger at (?P<trigger>[.\deE+]+) s)?"
)


def read_uff_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """The one run of a universal file; errors as in `read_records`."""
    source = path.name
    sets = [one for one in _sets(path, source) if one.get("func_type") == TIME_RESPONSE]
    if not sets:
        raise InputError(source, "holds no time response (data set 58, function type 1)", "Export time histories.")
    lengths = {len(one["data"]) for one in sets}
    steps = {round(float(one["abscissa_inc"]), 12) for one in sets}
    if len(lengths) > 1 or len(steps) > 1:
        raise InputError(
            source,
            f"its channels differ in length ({_few(lengths)} samples) or sampling interval ({_few(steps)} s)",
            "The channels of a record must be sampled together; export them again.",
        )
    (step,) = steps
    if not step > 0:
        raise InputError(source, f"sampling interval {step:g} s", "Export evenly spaced time histories.")
    values = np.column_stack([np.real(one["data"]) for one in sets]).astype(np.float64)
    columns = tuple(_column(one, number, sidecar is not None, source) for number, one in enumerate(sets, 1))
    return [DropColumns(values, columns, rate=1 / step, title=str(sets[0].get("id1", "")).strip(), drop=_drop(sets[0]))]


def _sets(path: Path, source: str) -> list[dict[str, Any]]:
    try:
        universal = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in universal.get_set_types()]
        sets = [universal.read_sets(i) for i, kind in enumerate(kinds) if kind == 58]
    except OSError as error:
        raise InputError(source, f"cannot be read ({error.strerror or error})", "Check the path.") from None
    except (ValueError, IndexError, KeyError, TypeError, struct.error, UnicodeDecodeError, OverflowError, MemoryError):
        raise InputError(
            source, "is damaged or not a universal file", "Export the record again as data set 58 or 58b."
        ) from None
    except Exception as error:
        # pyuff raises bare Exceptions for what it cannot read; anything of another type is ours to know about.
        if type(error) is not Exception:
            raise
        raise InputError(source, f"is not a readable universal file ({str(error)[:100]})", "Export it again.") from None
    for number, one in enumerate(sets, 1):
        if len(one["data"]) != int(one["num_pts"]):
            raise InputError(
                f"{source}, data set {number}",
                f"{len(one['data'])} samples, its head says {int(one['num_pts'])}",
                "The file is truncated: export it again.",
            )
    return sets


def _column(one: dict[str, Any], number: int, described: bool, source: str) -> DropColumn:
    named = CHANNEL_LINE.fullmatch(str(one.get("id3", "")).strip())
    label = str(one.get("ordinate_axis_units_lab", "")).strip()
    unit = label if label.upper() not in ("", "NONE") else UNIT_OF_DATA_TYPE.get(int(one["ordinate_spec_data_type"]))
    name = named["name"] if named else None
    if described:
        return DropColumn(name, label if label.upper() not in ("", "NONE") else None)
    direction = named["direction"] if named else DIRECTIONS.get(int(one["rsp_dir"]))
    if direction is None or unit is None:
        raise InputError(
            f"{source}, data set {number}",
            "states no direction" if direction is None else "states no unit",
            "Give direction and unit of every channel in a sidecar.",
        )
    sensor = int(one["rsp_node"])
    table = DropChannelTable(
        column=number,
        name=name or f"S{sensor}_{direction[1]}",
        sensor=sensor,
        wire=named["wire"] if named else "",
        position_m=float(named["position"]) if named else None,
        direction=direction,
        unit=unit,
    )
    return DropColumn(name, None, table)


def _drop(one: dict[str, Any]) -> DropDescription:
    found = DROP_LINE.fullmatch(str(one.get("id2", "")).strip())
    if found is None:
        return DropDescription()
    trigger = float(found["trigger"]) if found["trigger"] else None
    return DropDescription(float(found["mass"]), found["wire"].upper(), float(found["position"]), trigger)


def _few(values: set[Any]) -> str:
    return ", ".join(f"{value:g}" for value in sorted(values)[:4])
