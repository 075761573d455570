"""`pantocheck drop simulate` and `drop campaign`: simulated mass drops as records, like measured ones."""

import logging
from pathlib import Path
from typing import Annotated, get_args

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text, indent_text
from pantocheck.conformance.app.commands.options import DropCaseArgument, choose_drop_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.cases.study_tables import WireName
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import Axis
from pantocheck.conformance.core.step_log import ShareCallback, StepSequence
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.drop_campaign import (
    WIRE_NAMES,
    DropCampaign,
    SensorChain,
    list_drops,
    list_tension_changes,
    require_axes,
    simulate_records,
)
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.drops.drop_writing import check_drop_target, select_drop_writer

_LOGGER = logging.getLogger(__name__)


def drop_simulate_command(
    case: DropCaseArgument,
    out: Annotated[Path, typer.Option(help="Record to write: NAME.uff, NAME.csv or NAME.h5.")],
    number: Annotated[
        int | None,
        typer.Option("--drop", help="Number of the drop, from 1. Default: all drops, as NAME-1, NAME-2, ...", min=1),
    ] = None,
) -> CommandOutput:
    """Simulate the mass drops of a case as records.

    Example: pantocheck drop simulate vovan2015/mass-drop/stand-in --drop 1 --out drop.uff

    Then: pantocheck drop identify drop.uff --out modes
    """
    write = select_drop_writer(out)
    drop_case = choose_drop_case(case)
    drops = len(require_mass_drop(drop_case).drop)
    if number is not None and number > drops:
        raise InputError("--drop", f"there is no drop {number}", f"Case {drop_case.id} has {drops}, numbered from 1.")
    check_writable(out.parent)
    files, facts, lines = [], [], []
    numbers = list(range(1, drops + 1)) if number is None else [number]
    paths = [out] if len(numbers) == 1 else [out.with_name(f"{out.stem}-{n}{out.suffix}") for n in numbers]
    for path in paths:
        check_drop_target(path)
    with follow_steps("mass drops", len(numbers)) as progress:
        for n, path in zip(numbers, paths, strict=True):
            simulation = simulate_drop(drop_case, n, begin_drop(_LOGGER, f"drop {n} of {drops}"))
            progress.finish_task()
            record = simulation.record
            write(record, path)
            slack = simulation.decay.last_slack
            sensors = count_noun(len(record.channels), "sensor")
            droppers = "no slack dropper" if slack is None else f"last slack dropper {slack:.2f} s"
            files.append(path)
            facts.append({"drop": n, "duration_s": record.duration, "last_slack_s": slack})
            lines.append(indent_text(f"{record.duration:g} s, {sensors}, {droppers} after the release", f"drop {n}: "))
    return CommandOutput(escape_text(f"{drop_case.id}: {count_noun(len(files), 'drop')}"), facts, lines, files=files)


def begin_drop(logger: logging.Logger, drop: str) -> ShareCallback:
    """Report the start of a drop; returns the callback of its simulation."""
    return StepSequence(logger, drop, {"simulation": 1.0}).begin("simulation")


# `pantocheck drop campaign`: simulated mass drops of several masses, places and tensions.
TENSION_HELP = "Tension of {} [N]; repeat the option for several. Default: that of the case."


def drop_campaign_command(
    case: DropCaseArgument,
    out: Annotated[
        Path, typer.Option(help="Records to write: NAME.csv, .uff or .h5 gives NAME-01.csv, NAME-02.csv, ...")
    ],
    mass: Annotated[
        list[float] | None,
        typer.Option(help="Mass [kg]; repeat the option for several. Default: those of the case.", min=0.1, max=200),
    ] = None,
    place: Annotated[
        list[str] | None,
        typer.Option(help="Wire and position of the mass, e.g. CW:212.25 or MW:81; repeat the option for several."),
    ] = None,
    contact_tension: Annotated[list[float] | None, typer.Option(help=TENSION_HELP.format("one contact wire"))] = None,
    messenger_tension: Annotated[
        list[float] | None, typer.Option(help=TENSION_HELP.format("the messenger wire"))
    ] = None,
    repeats: Annotated[int, typer.Option(help="Records of each drop, with different noise.", min=1, max=100)] = 1,
    axes: Annotated[str, typer.Option(help="Axes of each sensor: z, or z,y on a line with stagger.")] = "z",
    noise: Annotated[
        float | None,
        typer.Option(help="RMS of the noise of a channel [SI unit]. Default: that of the case.", min=0, max=10),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the noise.", min=0)] = 1,
) -> CommandOutput:
    """Simulate drops of many masses, places and tensions.

    Example: pantocheck drop campaign vovan2015/mass-drop/stand-in --mass 20 --mass 40 --out drops/drop.csv

    Then: pantocheck drop identify drops/drop-*.csv --out modes --each
    """
    write = select_drop_writer(out)
    campaign = DropCampaign(
        masses=tuple(mass or ()),
        places=tuple(map(_parse_place, place or ())),
        contact_tensions=tuple(contact_tension or ()),
        messenger_tensions=tuple(messenger_tension or ()),
        repeats=repeats,
    )
    cases = [choose_drop_case(case, changes) for changes in list_tension_changes(campaign)]
    rms = require_mass_drop(cases[0]).noise_rms if noise is None else noise
    sensors = SensorChain(_parse_axes(axes), rms, seed)
    require_axes(cases[0], sensors.axes)
    drops = [(each, drop) for each in cases for drop in list_drops(each, campaign)]
    width = len(str(len(drops) * repeats))
    check_writable(out.parent)
    written: dict[Path, str] = {}
    with follow_steps("mass drops", len(drops)) as progress:
        for n, (drop_case, drop) in enumerate(drops):
            begin = begin_drop(_LOGGER, f"drop {n + 1} of {len(drops)}")
            numbers = range(n * repeats, (n + 1) * repeats)
            records = simulate_records(drop_case, drop, sensors, numbers, begin)
            for number, (record, _) in zip(numbers, records, strict=True):
                path = out.with_name(f"{out.stem}-{number + 1:0{width}d}{out.suffix}")
                write(record, path)
                written[path] = record.name
            progress.finish_task()
    return CommandOutput(
        Text(f"{len(drops)} drops, {len(written)} records"),
        [{"file": str(path), "record": name} for path, name in written.items()],
        [indent_text(name, f"{path.name}: ") for path, name in written.items()],
        files=[*written],
    )


def _parse_place(text: str) -> tuple[WireName, float]:
    wire, _, position = text.partition(":")
    try:
        return WIRE_NAMES[wire.strip().upper()], float(position)
    except (KeyError, ValueError):
        raise InputError(
            f"option --place {text[:60]!r}", "is not a wire and a position", "Write CW:212.25 or MW:81 ."
        ) from None


def _parse_axes(text: str) -> tuple[Axis, ...]:
    chosen = [part.strip() for part in text.split(",")]
    axes = tuple(axis for axis in get_args(Axis) if axis in chosen)
    if len(axes) != len(chosen):
        raise InputError(f"option --axes {text[:60]!r}", "is not a list of axes", "Write z, or z,y .")
    return axes
