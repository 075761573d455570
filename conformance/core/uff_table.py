"""Universal files, data set 58 (ASCII) and 58b (binary): one function of time per channel."""

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from pantocheck.conformance.core.files import produce_atomically
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
from pantocheck.conformance.core.units import SI_UNITS, MotionQuantity

TIME_HISTORIES = "Export time histories; of a pantograph, one response of a motion and a force."
TIME_RESPONSE, FREQUENCY_RESPONSE = 1, 4
"""Function types of the format."""
RESPONSE_UNITS = {
    (8, 13): "m_N", (11, 13): "m_s_N", (12, 13): "m_s2_N", (13, 8): "N_m", (13, 11): "N_s_m", (13, 12): "kg"
}  # fmt: skip
"""Units of a frequency response, as at the end of a key, by the data types of its numerator and denominator."""
DIRECTIONS = {1: "+x", 2: "+y", 3: "+z", -1: "-x", -2: "-y", -3: "-z"}
DATA_TYPES: dict[MotionQuantity, int] = {"acceleration": 12, "velocity": 11, "displacement": 8}
"""Specific data types of the format."""
TITLE_FIELDS = ("id1", "id2", "id3", "id4", "id5", "rsp_ent_name")
"""Fields that hold the name of a channel, by habit of the writing program."""
CHANNEL_LINE = re.compile(r"(?P<name>\S+) (?P<wire>\S+) at (?P<position>[-+.\deE]+) m dir (?P<direction>[-+][xyz])")
END_BYTES = 4096
"""Last part of a file that holds the end of its last data set, a line with -1."""
DROP_LINE = re.compile(
    r"(?P<mass>[.\deE+]+) kg on (?P<wire>\S+) at (?P<position>[-+.\deE]+) m(?:, trigger at (?P<trigger>[.\deE+]+) s)?"
)


def read_uff_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read the run of a universal file; arguments and errors as in `measured_table.Reader`."""
    where = f"record '{path.name}'"
    # pyuff raises plain `Exception` for some damaged files, and leaves out keys for others.
    with convert_damage_errors(where, "a universal file", Exception):
        return _build_tables(_read_sets(path, where), path.name, names, largest)


def _build_tables(sets: list[dict[str, Any]], source: str, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Table of the time responses among data sets; tables, if their rates may differ."""
    responses = [part for part in sets if part.get("func_type") == FREQUENCY_RESPONSE and _find_response_unit(part)]
    if responses and len(responses) == len(sets):
        return [_build_response(responses, source)]
    where, sets = f"record '{source}'", [data_set for data_set in sets if data_set.get("func_type") == TIME_RESPONSE]
    if not sets:
        raise InputError(where, "holds no time response (data set 58, function type 1)", TIME_HISTORIES)
    if isinstance(names, EveryRate):
        channels = (
            SampledChannel(
                TableColumn(title, unit=_unit_label(data_set)),
                np.real(data_set["data"]).astype(np.float64),
                float(data_set["abscissa_inc"]),
            )
            for title, data_set in zip(_find_titles(sets), sets, strict=True)
        )
        return group_by_sampling(source, channels, largest)
    values = stack_channels([np.real(data_set["data"]).astype(np.float64) for data_set in sets], where, largest)
    steps = {round(float(data_set["abscissa_inc"]), 12) for data_set in sets}
    if len(steps) > 1:
        found = ", ".join(f"{step:g}" for step in sorted(steps)[:4])
        raise InputError(where, f"has channels with different sampling intervals ({found} s)", SAMPLED_TOGETHER)
    (step,) = steps
    if not step > 0:
        raise InputError(where, f"states a sampling interval of {step:g} s", "The interval must be positive.")
    if isinstance(names, EveryChannel):
        titles = _find_titles(sets)
        columns = tuple(
            TableColumn(title, unit=_unit_label(data_set)) for title, data_set in zip(titles, sets, strict=True)
        )
        return [MeasuredTable(source, values, columns, rate=1 / step)]
    columns = tuple(
        _read_stated_facts(data_set) if names else _read_column(data_set, f"{where}, data set {number}")
        for number, data_set in enumerate(sets, 1)
    )
    return [MeasuredTable(source, values, columns, rate=1 / step, attributes=_read_attributes(sets[0]))]


def _find_response_unit(response: dict[str, Any]) -> str | None:
    """Unit of a frequency response, as at the end of a key; None if it is not one of motion and force."""
    numerator, denominator = (int(response.get(f"{part}_spec_data_type", 0)) for part in ("ordinate", "orddenom"))
    return RESPONSE_UNITS.get((numerator, denominator))


def _build_response(responses: list[dict[str, Any]], source: str) -> MeasuredTable:
    """Table of the frequency response of a file, by the names of `response_record`."""
    where = f"record '{source}'"
    if len(responses) > 1:
        raise InputError(where, f"holds {len(responses)} frequency responses", "Write one file per response.")
    (response,) = responses
    unit = _find_response_unit(response)
    values = np.asarray(response["data"], dtype=np.complex128)
    columns = tuple(TableColumn(name) for name in ("frequency_Hz", f"real_{unit}", f"imaginary_{unit}"))
    rows = (np.asarray(response["x"], dtype=np.float64), values.real, values.imag)
    return MeasuredTable(source, np.column_stack(rows), columns)


def _read_sets(path: Path, where: str) -> list[dict[str, Any]]:
    """All data sets 58 of a file."""
    _check_end(path, where)
    universal = pyuff.UFF(str(path))
    kinds = [int(kind) for kind in universal.get_set_types()]
    sets = [universal.read_sets(i) for i, kind in enumerate(kinds) if kind == 58]
    for number, data_set in enumerate(sets, 1):
        if len(data_set["data"]) != int(data_set["num_pts"]):
            raise InputError(
                f"{where}, data set {number}",
                f"holds {len(data_set['data'])} samples, but its head states {int(data_set['num_pts'])}",
                "Export the file again; its end is missing.",
            )
    return sets


def _check_end(path: Path, where: str) -> None:
    """Refuse a file that ends inside a data set: the reading library leaves out such a set without a word."""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - END_BYTES, 0))
        end = file.read().rstrip(b" \t\r\n\x00\x1a")
    if not end.endswith(b"-1"):
        raise InputError(where, "ends inside a data set", "It may be truncated: copy or export the file again.")


def _read_stated_facts(data_set: dict[str, Any]) -> TableColumn:
    """Name and unit that a data set states itself, for comparison with the sidecar."""
    name = _match_channel(data_set)
    return TableColumn(name["name"] if name else None, unit=_unit_label(data_set))


def _find_titles(sets: list[dict[str, Any]]) -> list[str]:
    """Names of the channels: the field that differs in all data sets."""
    matches = [_match_channel(data_set) for data_set in sets]
    if all(matches):
        return [match["name"] for match in matches if match]
    for key in TITLE_FIELDS:
        titles = [str(data_set.get(key, "")).strip() for data_set in sets]
        if len(set(titles)) == len(titles) and not {"", "NONE"} & {title.upper() for title in titles}:
            return titles
    return [f"set {number}" for number in range(1, len(sets) + 1)]


def _read_column(data_set: dict[str, Any], where: str) -> TableColumn:
    """Full description of a channel; without a unit label, the data type of the format gives the unit."""
    channel = _match_channel(data_set)
    types = {number: SI_UNITS[quantity] for quantity, number in DATA_TYPES.items()}
    unit = _unit_label(data_set) or types.get(int(data_set["ordinate_spec_data_type"]))
    direction = channel["direction"] if channel else DIRECTIONS.get(int(data_set["rsp_dir"]))
    if direction is None or unit is None:
        raise InputError(
            where,
            "states no direction" if direction is None else "states no unit",
            "Give direction and unit of every channel in a sidecar.",
        )
    sensor = int(data_set["rsp_node"])
    return TableColumn(
        channel["name"] if channel else f"S{sensor}_{direction[1]}",
        unit=unit,
        sensor=sensor,
        wire=channel["wire"] if channel else "",
        position=float(channel["position"]) if channel else None,
        direction=direction,
    )


def _match_channel(data_set: dict[str, Any]) -> re.Match[str] | None:
    return CHANNEL_LINE.fullmatch(str(data_set.get("id3", "")).strip())


def _unit_label(data_set: dict[str, Any]) -> str | None:
    label = str(data_set.get("ordinate_axis_units_lab", "")).strip()
    return None if label.upper() in ("", "NONE") else label


def _read_attributes(data_set: dict[str, Any]) -> dict[str, Any]:
    """Test and mass drop from the identification lines."""
    test = {"test": str(data_set.get("id1", "")).strip()}
    drop = DROP_LINE.fullmatch(str(data_set.get("id2", "")).strip())
    if drop is None:
        return test
    return test | {
        "drop_mass_kg": drop["mass"],
        "drop_wire": drop["wire"],
        "drop_position_m": drop["position"],
        "trigger_nominal_s": drop["trigger"],
    }


# Writing of the data sets of a universal file.
LINE_LENGTH = 80
"""Characters of an identification line."""


def write_data_sets(path: Path, data_sets: list[dict[str, Any]]) -> None:
    """Write data sets as pyuff prepares them.

    Raises:
        InputError: The file cannot be written.
    """

    def produce(temporary: Path) -> None:
        # pyuff's mode 'overwrite' damages binary files; adding to a new file does not.
        temporary.unlink()
        with warnings.catch_warnings():
            # pyuff leaves its files to the garbage collector, which closes them when it returns.
            warnings.simplefilter("ignore", ResourceWarning)
            pyuff.UFF(str(temporary)).write_sets(data_sets, mode="add")

    produce_atomically(path, produce)


def encode_identification_line(text: str) -> str:
    """Identification line: ASCII characters, at most `LINE_LENGTH`, never empty."""
    return text.encode("ascii", "replace").decode("ascii")[:LINE_LENGTH].strip() or "NONE"
