"""`pantocheck line statics`, `pantograph compare` and `drop compare`: a model beside measured values."""

import logging
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import EXIT_CODES, CommandOutput
from pantocheck.conformance.app.commands.console import (
    build_table,
    escape_text,
    format_number,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.app.commands.options import ElementOption, LineOption, ResponsesArgument, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.opened_drop import read_drop_run
from pantocheck.conformance.comparison.comparison_limits import DROPS, RESPONSES, read_comparison_limits
from pantocheck.conformance.comparison.drop_comparison import DampingChoice, DropTask, compare_drop
from pantocheck.conformance.comparison.drop_motion import GRAPHIC_BAND
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.comparison.static_comparison import build_tolerances, compare_statics
from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.files import check_writable, produce_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.step_log import StepSequence
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.elements.damping import DampingFile
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pages.comparison_page import build_comparison, find_headline
from pantocheck.conformance.pages.comparison_parts import list_remarks, name_criterion
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_document
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.quantities.limit_text import format_graded
from pantocheck.conformance.results.comparison_format import (
    ComparedValues,
    ModelComparison,
    ResponseComparison,
    ResponseQuantity,
    StaticComparison,
)
from pantocheck.conformance.results.drop_comparison_format import DropComparison


def write_comparison_files(comparison: ModelComparison, stem: Path) -> list[Path]:
    """Write the JSON file and the pages of a comparison to a path without suffix; returns the written files."""
    data = stem.with_name(f"{stem.name}.json")
    write_model(data, comparison)
    return [data, *write_document(build_comparison(comparison), stem)]


def build_comparison_output(
    comparison: ModelComparison, tables: Iterable[RenderableType], files: list[Path]
) -> CommandOutput:
    """Verdict, tables, criteria and remarks of a comparison; the exit code follows the verdict."""
    return CommandOutput(
        style_verdict(comparison.verdict) + escape_text(f" {find_headline(comparison)}"),
        comparison,
        [
            *tables,
            *_list_criteria(comparison.criteria),
            *(indent_text(remark, "warning: ") for remark in list_remarks(comparison)),
        ],
        files=files,
        remarks=remark_missing_formats(),
        exit_code=EXIT_CODES[comparison.verdict],
    )


def _list_criteria(criteria: tuple[Criterion, ...]) -> Iterator[RenderableType]:
    """Criteria as a table, and their reasons."""
    if criteria:
        table = build_table("criterion", "value", "limit", "verdict", right=("value", "limit"))
        for item in criteria:
            bounds = format_graded(item.value, item.lower, item.upper).bounds
            name = escape_text(name_criterion(item))
            table.add_row(name, format_number(item.value), bounds, style_verdict(item.verdict))
        yield table
    for item in criteria:
        if item.reason:
            yield indent_text(f"{name_criterion(item)}: {item.reason}")


# `pantocheck line statics`: elasticities and contact wire heights measured along a line beside its model.
ToleranceOption = float | None


def line_statics_command(
    table: Annotated[
        Path, typer.Argument(help=f"Table of the measured values, or its sidecar: {DocumentationPage.LINE_TABLES}.")
    ],
    line: LineOption,
    out: Annotated[Path, typer.Option(help="Folder for static_comparison.json, .html and .pdf, and a CSV per value.")],
    elasticity_tolerance: Annotated[
        ToleranceOption,
        typer.Option("--elasticity-tolerance-mm-N", help="Largest accepted difference of the elasticity.", min=0.0),
    ] = None,
    elasticity_tolerance_pct: Annotated[
        ToleranceOption,
        typer.Option("--elasticity-tolerance-pct", help="The same, relative to the measured elasticity.", min=0.0),
    ] = None,
    height_tolerance: Annotated[
        ToleranceOption,
        typer.Option("--height-tolerance-mm", help="Largest accepted difference of the contact wire height.", min=0.0),
    ] = None,
    element: ElementOption = 0.5,
) -> CommandOutput:
    """Compare measured static values with those of a line.

    A tolerance makes a criterion; without one, the differences are shown and not graded. No standard states a
    tolerance, so there is no default. A criterion is skipped if a part of the evaluated section was not measured.

    Example: pantocheck line statics measured.csv --line my-line.toml --out statics --height-tolerance-mm 10
    """
    tolerances = build_tolerances(
        {
            "elasticity_difference_mm_N": elasticity_tolerance,
            "elasticity_difference_pct": elasticity_tolerance_pct,
            "contact_wire_height_difference_mm": height_tolerance,
        }
    )
    line_file = read_line(line)
    record = read_static_record(table, line_file.geometry)
    check_writable(out)
    with follow_steps("line at rest"):
        comparison = compare_statics(record, line_file, element, tolerances)
        files = write_comparison_files(comparison, out / "static_comparison")
        files += [_write_differences(values, out / f"{values.name}.csv") for values in comparison.values]
    return build_comparison_output(comparison, [_tabulate_differences(comparison)], files)


def _write_differences(values: ComparedValues, path: Path) -> Path:
    unit = values.unit.replace("/", "_")
    names = ["row", "position_m", f"measured_{unit}", f"model_{unit}", f"difference_{unit}"]
    columns = (values.row, values.position_m, values.measured, values.model, values.difference)
    produce_atomically(path, lambda temporary: write_csv_table(temporary, names, np.column_stack(columns), 8))
    return path


def _tabulate_differences(comparison: StaticComparison) -> RenderableType:
    """Differences of all values."""
    numbers = ("mean", "RMS", "outliers", "missing")
    rows = (
        (
            values.name.replace("_", " "),
            values.unit,
            *(format_number(difference, 3) for difference in (values.mean_difference, values.rms_difference)),
            *(str(len(numbered)) for numbered in (values.outlier_rows, values.missing_rows)),
        )
        for values in comparison.values
    )
    return build_table("model - measured", "unit", *numbers, title="Evaluated section", right=numbers, rows=rows)


# `pantocheck pantograph compare`: frequency responses measured at a pantograph head beside those of its model.
PRINTED_DEVIATIONS: tuple[ResponseQuantity, ...] = (
    "modulus_deviation_pct",
    "phase_deviation_deg",
    "complex_deviation_pct",
)


def pantograph_compare_command(
    responses: ResponsesArgument,
    pantograph: Annotated[Path, typer.Option(help="Pantograph file.")],
    out: Annotated[Path, typer.Option(help="Folder for response_comparison.json, .html and .pdf.")],
    limits: Annotated[
        Path | None, typer.Option(help=f"File of limits: {DocumentationPage.PANTOGRAPH_RESPONSE}.")
    ] = None,
) -> CommandOutput:
    """Compare measured responses with a pantograph.

    A table holds frequency, modulus and phase of one measurement; give one per static force and height. Limits make
    criteria; without them, the deviations are shown and not graded.

    Example: pantocheck pantograph compare at-55N.csv at-70N.csv --pantograph my-pantograph.toml --out response
    """
    records = [read_response(path) for path in responses]
    model = read_model(pantograph, PantographFile, "pantograph")
    graded = read_comparison_limits(limits, RESPONSES)
    check_writable(out)
    with follow_steps("comparing"):
        comparison = compare_responses(records, model, graded)
        files = write_comparison_files(comparison, out / "response_comparison")
    return build_comparison_output(comparison, [_tabulate_deviations(comparison)], files)


def _tabulate_deviations(comparison: ResponseComparison) -> RenderableType:
    """RMS deviations of every band."""
    numbers = ("modulus %", "phase °", "complex %")
    table = build_table("response", "band", *numbers, title="RMS deviation of the model", right=numbers)
    for response in comparison.responses:
        for band in response.bands:
            if band.deviations:
                values = (format_number(band.deviations[key], 3) for key in PRINTED_DEVIATIONS)
                table.add_row(escape_text(response.name), f"{band.band_Hz[0]:g} to {band.band_Hz[1]:g} Hz", *values)
    return table


# `pantocheck drop compare`: a recorded mass drop beside its simulation under one or more damping models.
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
