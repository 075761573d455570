"""`pantocheck describe`: channels, rates, ranges and gaps of a measured file, and a sidecar to complete."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, indent_text
from pantocheck.conformance.app.commands.new_command import write_new_file
from pantocheck.conformance.app.commands.sidecar_drafts import DescribedTable, draft_drop_sidecar, draft_record_sidecar
from pantocheck.conformance.core.csv_table import open_text_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, EVERY_RATE, MeasuredTable, read_tables
from pantocheck.conformance.core.text_reading import SEPARATOR_NAMES
from pantocheck.conformance.core.text_settings import TextSettings, name_encoding
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.drops.drop_reading import LARGEST_DROP
from pantocheck.conformance.records.channel_facts import (
    ChannelFacts,
    TimeFacts,
    find_time,
    guess_channels,
    list_channel_facts,
)


def describe_command(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE ...", help="Files of a measurement: CSV, HDF5, MATLAB, UFF, TDMS, MDF, Parquet, XLSX or ODS."
        ),
    ],
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

    Several files become the sources of one record.

    Examples:

    pantocheck describe logger.csv

    pantocheck describe logger.csv --sidecar logger.toml

    pantocheck describe train.csv mast.csv --sidecar passage.toml
    """
    if kind not in (None, "record", "mass-drop"):
        raise InputError("option --kind", f"there is no kind {kind!r}", "Give record or mass-drop.")
    stated = {"separator": separator, "decimal": decimal, "header_lines": header_lines, "encoding": encoding}
    layout = validate_model(
        {key: value for key, value in stated.items() if value is not None}, TextSettings, "command line"
    )
    if sidecar is not None and sidecar.exists():
        raise InputError(f"file '{sidecar}'", "exists already", "Give another name; no file is overwritten.")
    for file in files:
        if sidecar is not None and file.absolute().parent.resolve() != sidecar.absolute().parent.resolve():
            hint = "Write the sidecar beside its files; copy files of other folders there first."
            raise InputError(f"file '{file}'", f"is not in the folder of the sidecar '{sidecar}'", hint)
    parts = [part for file in files for part in _describe_parts(file, layout)]
    drop = kind == "mass-drop" or (kind is None and any(part.moves for part in parts))
    if drop and len(files) > 1:
        raise InputError(f"file '{files[1].name}'", "is a second file of a mass drop", "Describe each file alone.")
    if not drop:  # the first file of a record holds the force
        parts.sort(key=lambda part: -len(guess_channels(part.facts).get("force", [])))
    if sidecar is not None:
        draft = draft_drop_sidecar(parts[0], layout) if drop else draft_record_sidecar(parts, layout)
        write_new_file(sidecar, draft)
        follow = "drop identify" if drop else "assess"
        next_step = [f"Complete it, then: pantocheck check {sidecar}, and pantocheck {follow}"]
    else:
        names = " ".join(map(str, files))
        next_step = [
            "A sidecar to complete:",
            f"  pantocheck describe {names} --sidecar {files[0].with_suffix('.toml')}",
        ]
    described = [
        {
            "time": None if part.time is None else _list_facts(part.time),
            "channels": [_list_facts(fact) for fact in part.facts],
        }
        for part in parts
    ]
    several = [{"file": part.file, **facts} for part, facts in zip(parts, described, strict=True)]
    return CommandOutput(
        escape_text("\n".join(f"{file.name}: {file.stat().st_size / 1e6:.3g} MB" for file in files)),
        described[0] if len(parts) == 1 else {"sources": several},
        [
            *(line for part in parts for line in _show(part, files, layout, named=len(parts) > 1)),
            *(Unwrapped(escape_text(line).plain) for line in next_step),
        ],
        files=[] if sidecar is None else [sidecar],
    )


def _describe_parts(file: Path, layout: TextSettings) -> list[DescribedTable]:
    """Facts on each rate of a file, or on its first run."""
    tables = _read(file, layout)
    shown = tables[:1] if tables[0].run else [table for table in tables if table.values.shape[0] > 1] or tables[:1]
    runs = len(tables) if tables[0].run else 1
    return [
        DescribedTable(file.name, table.values.shape[0], list_channel_facts(table), find_time(table), runs)
        for table in shown
    ]


def _show(
    part: DescribedTable, files: Sequence[Path], layout: TextSettings, *, named: bool
) -> Iterator[RenderableType]:
    """Lines and table of a part for the terminal."""
    file = next(file for file in files if file.name == part.file)
    name = [f"{part.file}:"] if named else []
    runs = [f"{part.runs} runs; the first one is described"] if part.runs > 1 else []
    size = f"{len(part.facts)} columns, {part.samples} samples"
    for line in (*name, *_describe_layout(file, layout), *runs, size, *_describe_time(part.time)):
        yield indent_text(line.lstrip(" "), line[: len(line) - len(line.lstrip(" "))])
    yield Text()
    yield _build_channel_table(part.facts)
    yield from (indent_text(remark, f"{fact.column.label}: ") for fact in part.facts for remark in fact.remarks)
    yield Text()


def _list_facts(facts: ChannelFacts | TimeFacts) -> dict[str, object]:
    """Facts for a program; a column is given by its name."""
    column = None if facts.column is None else facts.column.label
    return {"column": column, **{key: value for key, value in vars(facts).items() if key != "column"}}


def _read(file: Path, layout: TextSettings) -> list[MeasuredTable]:
    """Tables of the file; a hint on the sidecar names the options of this command, too."""
    try:
        return read_tables(file, EVERY_RATE, LARGEST_DROP, layout=layout)
    except InputError as error:
        if "[table]" not in error.hint:
            raise
        options = "Options of `describe`: --separator, --decimal, --header-lines, --encoding."
        raise InputError(error.where, error.found, f"{error.hint} {options}") from None


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
