"""`pantocheck describe`: channels, rates, ranges and gaps of a measured file, and a sidecar to complete."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, indent_text
from pantocheck.conformance.app.commands.new_command import write_new_file
from pantocheck.conformance.core.csv_table import open_text_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, EVERY_CHANNEL, MeasuredTable, read_tables
from pantocheck.conformance.core.text_reading import SEPARATOR_NAMES
from pantocheck.conformance.core.text_settings import TextSettings, name_encoding
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.drops.drop_reading import LARGEST_DROP
from pantocheck.conformance.records.channel_facts import (
    ChannelFacts,
    TimeFacts,
    find_time,
    guess_channels,
    is_acceleration,
    is_drop_channel,
    list_channel_facts,
    list_force_signals,
)
from pantocheck.conformance.records.record import CHANNELS, find_column


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
    moves = "force" not in guess_channels(facts) and any(map(is_acceleration, facts))
    drop = kind == "mass-drop" or (kind is None and moves)
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


# Commented sidecars of a logger file, to be completed.
TO_DO = "COMPLETE:"
"""Mark of the lines that the user completes."""


def draft_record_sidecar(file: str, facts: Sequence[ChannelFacts], time: TimeFacts | None, layout: TextSettings) -> str:
    """Sidecar of a contact-force record, for a table with some columns, a time and a stated layout."""
    own = all(find_column(fact.column.name or "", fact.column.row) for fact in facts)
    guesses = guess_channels(facts)
    forces = len(guesses.get("force", [])) or 1
    lines = [
        f"# Sidecar of {file}. Complete the lines with {TO_DO.rstrip(':')}, and check the others.",
        f"# See {DocumentationPage.RECORDS}, and {DocumentationPage.LOGGER_FILES}.",
        'schema = "pantocheck.record/1"',
        f"file = {json.dumps(file, ensure_ascii=False)}",
        f"# speed_km_h = 250.0              # {TO_DO} nominal speed of the train",
        f"pantographs = {forces:<19} # check: pantographs with a contact force",
        f'# filter_applied_Hz = "none"      # {TO_DO} cut-off of a low-pass filter before recording, or "none"',
        f"# evaluated_m = [0.0, 1000.0]     # {TO_DO} start and end of the analysis section, x in running direction",
    ]
    if forces > 1:
        spacing = ", ".join(["200.0"] * (forces - 1))
        lines.append(f"# spacing_m = [{spacing}]".ljust(34) + f"# {TO_DO} distances between successive pantographs")
    lines.append("# support_position_m = []         # positions of the supports with an uplift, x in running direction")
    lines += _list_layout(layout)
    lines += ["", "[line]", "# span_m = 65.0                   # longest span", "# wave_speed_m_s = 120.0"]
    lines += ["# uplift_space_mm = 120.0         # space for the uplift at the supports"]
    lines += ["", "[system]", 'name = "measurement"              # name of the measuring system']
    if not own:
        lines += _list_column_lines(facts, guesses, time)
    lines += _list_position_help(guesses)
    return "\n".join(lines) + "\n"


def _list_layout(layout: TextSettings) -> list[str]:
    stated = layout.model_dump(exclude_none=True)
    return ["", "[table]", *(f"{key} = {json.dumps(value)}" for key, value in stated.items())] if stated else []


def _list_column_lines(
    facts: Sequence[ChannelFacts], guesses: dict[str, list[ChannelFacts]], time: TimeFacts | None
) -> Iterator[str]:
    """Lines of the table `columns`: guesses by unit and name, and the other columns as comments."""
    used = set[int]()
    yield from ("", "[columns]                          # guessed from names and units: check each line")
    if time is not None and time.column is not None:
        fact = next(fact for fact in facts if fact.column is time.column)
        used.add(id(fact))
        yield _column_line("time_s", fact, "s" if fact.unit is None else None)
    elif time is None:
        yield f'# time_s = {{ column = "...", unit = "s" }}   # {TO_DO} column of the time'
    for channel, found in guesses.items():
        several = CHANNELS[channel].per == "support"
        for number, fact in enumerate(found, 1):
            used.add(id(fact))
            name = CHANNELS[channel].column(number)
            remark = f"   # {TO_DO} support_position_m above" if several else ""
            yield f"{'# ' if several else ''}{_column_line(name, fact, None)}{remark}"
    if len(guesses.get("force", [])) > 1:
        yield "# forces of one pantograph (left and right): one [columns.force_1_N] with sum = [...], see"
        yield f"# {DocumentationPage.LOGGER_FILES}"
    signals = list_force_signals(facts)
    used |= {id(fact) for fact in signals}
    for number, fact in enumerate(signals, 1):
        column = json.dumps(fact.column.label, ensure_ascii=False)
        yield f'# force_{number}_N = {{ column = {column}, unit = "N", scale = 1.0 }}   # {TO_DO} N per {fact.unit}'
    if len(signals) > 1:
        yield "# or the sum of several sensors of one pantograph: [columns.force_1_N] with sum"
        yield f"# in {DocumentationPage.LOGGER_FILES}"
    if "force" not in guesses and not signals:
        yield f'# force_1_N = {{ column = "...", unit = "N" }}   # {TO_DO} column of the contact force'
    unused = [fact.column.label for fact in facts if id(fact) not in used and fact.column.label]
    if unused:
        yield f"# not used: {', '.join(json.dumps(name, ensure_ascii=False) for name in unused)}"


def _column_line(name: str, fact: ChannelFacts, unit: str | None) -> str:
    stated = fact.unit if fact.unit is not None else unit
    column = json.dumps(fact.column.label, ensure_ascii=False)
    known = f", unit = {json.dumps(stated, ensure_ascii=False)}" if stated is not None else ""
    remark = "" if stated is not None else f"   # {TO_DO} unit"
    return f"{name} = {{ column = {column}{known} }}{remark}"


def _list_position_help(guesses: dict[str, list[ChannelFacts]]) -> Iterator[str]:
    """Commented tables for the position."""
    kilometres = [fact for fact in guesses.get("position", []) if fact.unit == "km"]
    if kilometres:
        direction = "decreasing" if kilometres[0].trend < 0 else "increasing"
        yield from (
            "",
            f"# [track]                        # {TO_DO} the position is a kilometre of the line, which x counts from",
            "# zero_km = 0.0                  # x = 0",
            f'# kilometres = "{direction}"      # in running direction, as in the file',
        )
    elif "position" not in guesses:
        yield from (
            "",
            "# position: a column position_1_m above; or speed_m_s above and start_m = 0.0 at the top; or",
            "# [position]",
            '# kind = "counter"               # or "pulses", "marks"',
            '# column = "..."',
            "# metres_per_pulse = 0.25",
            "# start_m = 0.0",
        )


def draft_drop_sidecar(file: str, facts: Sequence[ChannelFacts], time: TimeFacts | None, layout: TextSettings) -> str:
    """Sidecar of a mass-drop record."""
    others = [fact for fact in facts if time is None or fact.column is not time.column]
    channels = [(number, fact) for number, fact in enumerate(others, 1) if fact.missing < 1 and is_drop_channel(fact)]
    unused = [fact.column.label for fact in others if all(fact is not used for _, used in channels)]
    rate = "200.0" if time is None else f"{time.rate:.6g}"
    rate = rate if "." in rate or "e" in rate else f"{rate}.0"
    lines = [
        f"# Sidecar of {file}. Complete the lines with {TO_DO.rstrip(':')}, and check the others.",
        f"# See {DocumentationPage.IDENTIFICATION}.",
        "[test]",
        'name = ""',
        "# spans_m = [63.0, 63.0]          # lengths of the spans",
        "# cw_tension_n = 20000.0          # tension of one contact wire",
        "# mw_tension_n = 15000.0",
        "",
        "[drop]",
        "# mass_kg = 40.0",
        '# wire = "CW"                     # CW contact wire, MW messenger wire',
        "# position_m = 0.0                # from the first support",
        "",
        "[record]",
        f"sampling_rate_hz = {rate:<16}# {'COMPLETE' if time is None else 'found in the file'}",
        "# trigger_nominal_s = 5.0         # planned time of the release",
        *_list_layout(layout),
    ]
    if unused:
        lines += ["", f"# not used: {', '.join(json.dumps(name, ensure_ascii=False) for name in unused)}"]
    for number, fact in channels:
        name = fact.column.name or f"channel {number}"
        unit = json.dumps(fact.unit or "m/s2", ensure_ascii=False)
        lines += [
            "",
            "[[channel]]",
            f"column = {number}",
            f"name = {json.dumps(name, ensure_ascii=False)}",
            f"sensor = {number:<26}# {TO_DO} one number per sensor",
            f'direction = "+z"                  # {TO_DO} x along the track, y lateral, z upward',
            f"unit = {unit:<28}# {'found in the file' if fact.unit else f'{TO_DO} unit'}",
            '# wire = "CW"',
            "# position_m = 0.0                # from the first support",
        ]
    return "\n".join(lines) + "\n"
