"""`pantocheck drop compare`: a recorded mass drop beside its simulation under one or more damping models."""

import logging
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.comparison_output import build_comparison_output, write_comparison_files
from pantocheck.conformance.app.commands.console import build_table, escape_text, format_number
from pantocheck.conformance.app.commands.options import ElementOption, LineOption, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.opened_drop import read_drop_run
from pantocheck.conformance.comparison.comparison_limits import DROPS, read_comparison_limits
from pantocheck.conformance.comparison.drop_comparison import DampingChoice, DropTask, compare_drop
from pantocheck.conformance.comparison.drop_motion import GRAPHIC_BAND
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.step_log import StepSequence
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.elements.damping import DampingFile
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.drop_comparison_format import DropComparison

_LOGGER = logging.getLogger(__name__)

DEFAULT_WINDOWS = ((0.0, 10.0), (60.0, 70.0))
"""Windows after the release [s]: the first ten seconds, and ten seconds a minute later."""

SHORTEST_WINDOW_S, LATEST_WINDOW_S = 1.0, 900.0
"""Shortest window, about a period of the lowest mode, and latest end of one [s]."""


def drop_compare_command(
    record: Annotated[
        Path, typer.Argument(help=f"Record of a mass drop, with its sidecar: {DocumentationPage.IDENTIFICATION}.")
    ],
    line: LineOption,
    out: Annotated[Path, typer.Option(help="Folder for drop_comparison.json, .html and .pdf.")],
    damping: Annotated[
        list[Path] | None,
        typer.Option(help="Damping file; repeat the option for several. The first is graded. Default: the line's own."),
    ] = None,
    limits: Annotated[Path | None, typer.Option(help=f"File of limits: {DocumentationPage.COMPARE_DROP}.")] = None,
    run: Annotated[int, typer.Option(help="Number of the run in a record with several, from 1.", min=1)] = 1,
    window: Annotated[
        list[str] | None,
        typer.Option(
            metavar="START:END", help="Window after the release [s]; repeat for several.", show_default="0:10, 60:70"
        ),
    ] = None,
    release_duration: Annotated[
        float, typer.Option("--release-s", help="Time in which the weight decreases to zero [s].", min=0.0, max=5.0)
    ] = 0.0,
    element: ElementOption = 0.5,
    time_step: Annotated[float, typer.Option(help="Time step [s].", min=1e-5, max=0.005)] = 0.001,
) -> CommandOutput:
    """Compare a recorded mass drop with its simulation.

    The record states mass, wire and position; the release is found in the record. Limits make criteria; without them,
    the differences are shown and not graded.

    Example: pantocheck drop compare T1.h5 --line my-line.toml --damping measured.toml --out drop
    """
    line_file = read_line(line)
    task = DropTask(
        line=line_file,
        models=_read_models(damping or [], line_file),
        windows=tuple(dict.fromkeys(map(_parse_window, window))) if window else DEFAULT_WINDOWS,
        element=element,
        time_step=time_step,
        release_duration=release_duration,
        limits=read_comparison_limits(limits, DROPS),
    )
    drop = read_drop_run(record, run, "--run")
    check_writable(out)
    with follow_steps("comparison of the drop"):
        steps = StepSequence(_LOGGER, drop.name, {"simulation": 0.95, "report": 0.05})
        comparison = compare_drop(drop, task, steps.begin("simulation"))
        steps.begin("report")
        files = write_comparison_files(comparison, out / "drop_comparison")
    return build_comparison_output(comparison, _describe_agreement(comparison), files)


def _read_models(paths: list[Path], line: LineFile) -> dict[str, DampingChoice]:
    """Damping models by the name of their file; the damping of the line if there is no file."""
    if not paths:
        return {"line": DampingChoice(line.title, line.damping)}
    names = name_damping_files(paths)
    return {
        name: DampingChoice(path.name, read_model(path, DampingFile, "damping").damping)
        for name, path in zip(names, paths, strict=True)
    }


def name_damping_files(paths: Sequence[Path]) -> list[str]:
    """Stems of the files; with the name of the folder in front where several files have the same stem."""
    stems = [path.stem for path in paths]
    names = [
        f"{path.absolute().parent.name}/{path.stem}" if stems.count(path.stem) > 1 else path.stem for path in paths
    ]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                "--damping", f"two files have the name {name}", "Rename a file or its folder: reports name both."
            )
    return names


def _parse_window(text: str) -> tuple[float, float]:
    """Start and end of a window [s]."""
    try:
        start, end = map(float, text.split(":"))
    except ValueError:
        start, end = math.nan, math.nan
    if not (start >= 0 and start + SHORTEST_WINDOW_S <= end <= LATEST_WINDOW_S):
        raise InputError(
            "--window",
            f"{text[:40]!r} is not a window after the release",
            f"Give START:END in seconds, e.g. 0:10; at least {SHORTEST_WINDOW_S:g} s, up to {LATEST_WINDOW_S:g} s.",
        )
    return start, end


def _describe_agreement(comparison: DropComparison) -> Iterator[RenderableType]:
    """Drop, and agreement of velocity and acceleration below 20 Hz."""
    drop = comparison.drop
    yield escape_text(
        f"{comparison.record.name}: {drop.mass_kg:g} kg on {drop.wire}, released at {drop.release_s:.4f} s"
    )
    numbers = ("RMS ratio", "correlation")
    table = build_table("motion", "window", "place", "model", *numbers, title=f"{GRAPHIC_BAND.text}", right=numbers)
    for row in comparison.statistics:
        if row.band_Hz == GRAPHIC_BAND and row.record_rms is not None:
            start, end = row.window_s
            for model in row.models:
                table.add_row(
                    row.motion,
                    f"{start:g} to {end:g} s",
                    escape_text(row.place),
                    escape_text(model.model),
                    format_number(model.rms_ratio),
                    format_number(model.correlation),
                )
    yield table
