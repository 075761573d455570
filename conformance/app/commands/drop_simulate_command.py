"""`pantocheck drop simulate`: simulated mass drops as records that can be identified like measured ones."""

import logging
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text, indent_text
from pantocheck.conformance.app.commands.options import DropCaseArgument, choose_drop_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.step_log import ShareCallback, StepSequence
from pantocheck.conformance.core.texts import count_noun
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
    """Report the begin of a drop; returns the callback of its simulation."""
    return StepSequence(logger, drop, {"simulation": 1.0}).begin("simulation")
