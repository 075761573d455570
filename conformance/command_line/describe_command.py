"""`pantocheck describe`: channels, rates, ranges and gaps of a measured file, and a sidecar to complete."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.input_files.formats.csv_table import open_text_table
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import EVERY_CHANNEL, MeasuredTable
from pantocheck.conformance.input_files.table_formats import CSV, read_tables
from pantocheck.conformance.input_files.text_encoding import name_encoding
from pantocheck.conformance.input_files.text_layout import SEPARATOR_NAMES
from pantocheck.conformance.input_files.text_settings import TextSettings
from pantocheck.conformance.input_files.toml_file import validate_model
from pantocheck.conformance.mass_drops.drop_reading import LARGEST_DROP
from pantocheck.conformance.own_files.channel_facts import (
    ChannelFacts,
    TimeFacts,
    find_time,
    list_channel_facts,
)
from pantocheck.conformance.own_files.channel_guess import guess_channels, is_acceleration
from pantocheck.conformance.own_files.new_files import write_new_file
from pantocheck.conformance.own_files.sidecar_draft import draft_drop_sidecar, draft_record_sidecar

TEXT_WIDTH = 80
NAME_WIDTH = 26


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
) -> None:
    """Describe a measured file: channels, rates, ranges, gaps and suspicious contents.

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
    lines = [f"{file.name}: {file.stat().st_size / 1e6:.3g} MB", *_describe_layout(file, layout)]
    lines += [f"{len(tables)} runs; the first one is described"] if len(tables) > 1 else []
    lines += [*_describe_table(tables[0], facts, time)]
    for line in lines:
        typer.echo(strip_control_characters(line))
    if sidecar is not None:
        draft = draft_drop_sidecar if drop else draft_record_sidecar
        write_new_file(sidecar, draft(file.name, facts, time, layout))
        follow = "identify" if drop else "assess"
        typer.echo(f"written: {sidecar}")
        typer.echo(f"Complete it, then: pantocheck check {sidecar}, and pantocheck {follow}")
    else:
        typer.echo("A sidecar to complete:")
        typer.echo(f"  pantocheck describe {file} --sidecar {file.with_suffix('.toml')}")


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
        yield from textwrap.wrap(", ".join(parts), TEXT_WIDTH, subsequent_indent="  ")
        for line in layout.preface[:5]:
            yield f"  | {line}"[:TEXT_WIDTH]
        if len(layout.preface) > 5:
            yield f"  | ... {len(layout.preface)} lines above the names"


def _describe_table(table: MeasuredTable, facts: list[ChannelFacts], time: TimeFacts | None) -> Iterator[str]:
    yield f"{len(facts)} columns, {table.values.shape[0]} samples"
    if time is None:
        yield "time: not found; give its column, or the rate"
    else:
        yield f"time: {time.source}, {time.rate:.6g} Hz, {time.duration:.6g} s"
        yield from (f"  {remark}" for remark in time.remarks)
    yield ""
    yield f"{'name':{NAME_WIDTH}} {'unit':6} {'from':>11} {'to':>11} missing"
    for fact in facts:
        name = fact.column.label or "(no name)"
        short = name if len(name) <= NAME_WIDTH else name[: NAME_WIDTH - 3] + "..."
        if fact.missing == 1:
            yield f"{short:{NAME_WIDTH}} {fact.unit or '':6.6} text or empty"
            continue
        missing = f"{100 * fact.missing:.2g} %" if fact.missing else ""
        numbers = f"{fact.smallest:11.5g} {fact.largest:11.5g}"
        yield f"{short:{NAME_WIDTH}} {fact.unit or '':6.6} {numbers} {missing}".rstrip()
        yield from (f"    {remark}"[:TEXT_WIDTH] for remark in fact.remarks)
    yield ""
