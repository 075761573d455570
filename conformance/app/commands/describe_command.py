"""`pantocheck describe`: channels, rates, ranges and gaps of a measured file, and a sidecar to complete."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, indent_text
from pantocheck.conformance.app.new_files import write_new_file
from pantocheck.conformance.app.sidecar_draft import draft_drop_sidecar, draft_record_sidecar
from pantocheck.conformance.core.csv_table import open_text_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, EVERY_CHANNEL, MeasuredTable, read_tables
from pantocheck.conformance.core.text_reading import SEPARATOR_NAMES
from pantocheck.conformance.core.text_settings import TextSettings, name_encoding
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.drops.drop_reading import LARGEST_DROP
from pantocheck.conformance.records.channel_facts import (
    ChannelFacts,
    TimeFacts,
    find_time,
    guess_channels,
    is_acceleration,
    list_channel_facts,
)


def describe_command(
    file: Annotated[Path, typer.Argument(help="File of a measurement: CSV, HDF5, MATLAB, UFF, TDMS or MDF.")],
    sidecar: Annotated[
        Path | None, typer.Option("--sidecar", "--out", help="Write a commented sidecar to this new file.")
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(help="Kind of the sidecar: record or mass-drop.", show_default="by the units and names"),
    ] = None,
    separator: Annotated[str | None, typer.Option(help="Separator of the columns of a text table.")] = None,
    decimal: Annotated[str | None, typer.Option(help="Decimal mark of a text table.")] = None,
    header_lines: Annotated[int | None, typer.Option(help="Lines above the names of a text table.")] = None,
    encoding: Annotated[str | None, typer.Option(help="Encoding of a text table.")] = None,
) -> CommandOutput:
    """Describe the channels of a measured file.

    Examples:

    pantocheck describe logger.csv

    pantocheck describe logger.csv --sidecar logger.toml
    """
    if kind not in (None, "record", "mass-drop"):
        raise InputError("option --kind", f"there is no kind {kind!r}", "Give record or mass-drop.")
    stated = {"separator": separator, "decimal": decimal, "header_lines": header_lines, "encoding": encoding}
    layout = validate_model(
        {key: value for key, value in stated.items() if value is not None}, TextSettings, "command line"
    )
    if sidecar is not None and sidecar.exists():
        raise InputError(f"file '{sidecar}'", "exists already", "Give another name; no file is overwritten.")
    tables = _read(file, layout)
    facts, time = list_channel_facts(tables[0]), find_time(tables[0])
    drop = kind == "mass-drop" or (kind is None and is_drop(facts))
    runs = [f"{len(tables)} runs; the first one is described"] if len(tables) > 1 else []
    size = f"{len(facts)} columns, {tables[0].values.shape[0]} samples"
    lines = [*_describe_layout(file, layout), *runs, size, *_describe_time(time)]
    if sidecar is not None:
        draft = draft_drop_sidecar if drop else draft_record_sidecar
        write_new_file(sidecar, draft(file.name, facts, time, layout))
        follow = "drop identify" if drop else "assess"
        next_step = [f"Complete it, then: pantocheck check {sidecar}, and pantocheck {follow}"]
    else:
        next_step = ["A sidecar to complete:", f"  pantocheck describe {file} --sidecar {file.with_suffix('.toml')}"]
    return CommandOutput(
        escape_text(f"{file.name}: {file.stat().st_size / 1e6:.3g} MB"),
        {"time": None if time is None else _list_facts(time), "channels": [_list_facts(fact) for fact in facts]},
        [
            *(indent_text(line.lstrip(" "), line[: len(line) - len(line.lstrip(" "))]) for line in lines),
            Text(),
            _build_channel_table(facts),
            *(indent_text(remark, f"{fact.column.label}: ") for fact in facts for remark in fact.remarks),
            Text(),
            *(Unwrapped(escape_text(line).plain) for line in next_step),
        ],
        files=[] if sidecar is None else [sidecar],
    )


def _list_facts(facts: ChannelFacts | TimeFacts) -> dict[str, object]:
    """Facts for a program; a column is given by its name."""
    column = None if facts.column is None else facts.column.label
    return {"column": column, **{key: value for key, value in vars(facts).items() if key != "column"}}


def _read(file: Path, layout: TextSettings) -> list[MeasuredTable]:
    """Tables of the file; a hint on the sidecar names the options of this command, too."""
    try:
        return read_tables(file, EVERY_CHANNEL, LARGEST_DROP, layout=layout)
    except InputError as error:
        if "[table]" not in error.hint:
            raise
        options = "Options of `describe`: --separator, --decimal, --header-lines, --encoding."
        raise InputError(error.where, error.found, f"{error.hint} {options}") from None


def is_drop(facts: list[ChannelFacts]) -> bool:
    """Whether the channels are probably those of a mass drop: accelerations, and no force."""
    return "force" not in guess_channels(facts) and any(map(is_acceleration, facts))


def _describe_layout(file: Path, settings: TextSettings) -> Iterator[str]:
    """Layout of a text table and its first lines above the names."""
    if file.suffix.lower() not in CSV.suffixes:
        return
    where = f"record '{file.name}'"
    with open_text_table(file, where, settings) as (layout, _):
        parts = [
            f"encoding {settings.encoding or name_encoding(file, where)}",
            f"separator {SEPARATOR_NAMES[layout.separator]}",
            f"decimal {'mark: none' if layout.decimal is None else {'.': 'point', ',': 'comma'}[layout.decimal]}",
            f"numbers from line {layout.first}",
            *(["a line of units"] if layout.units else []),
        ]
        yield ", ".join(parts)
        yield from (f"  | {line}" for line in layout.preface[:5])
        if len(layout.preface) > 5:
            yield f"  | ... {len(layout.preface)} lines above the names"


def _describe_time(time: TimeFacts | None) -> Iterator[str]:
    """Source, rate and duration of the time, and remarks on it."""
    if time is None:
        yield "time: not found; give its column, or the rate"
    else:
        yield f"time: {time.source}, {time.rate:.6g} Hz, {time.duration:.6g} s"
        yield from (f"  {remark}" for remark in time.remarks)


def _build_channel_table(facts: Sequence[ChannelFacts]) -> FittedTable:
    """Unit, range and missing values of every channel."""
    numbers = ("from", "to", "missing")
    table = build_table("name", "unit", *numbers, unbroken=("unit", *numbers), right=numbers)
    for fact in facts:
        name, unit = escape_text(fact.column.label or "(no name)"), escape_text(fact.unit or "")
        if fact.missing == 1:
            table.add_row(name, unit, "", "", "text or empty")
            continue
        missing = f"{100 * fact.missing:.2g} %" if fact.missing else ""
        table.add_row(name, unit, f"{fact.smallest:.5g}", f"{fact.largest:.5g}", missing)
    return table
