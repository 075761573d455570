"""`pantocheck line update`: a line as built, from static measurements, modes and passages."""

from pathlib import Path
from typing import Annotated

import tomli_w
import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import EXIT_CODES, CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text, format_number, style_verdict
from pantocheck.conformance.app.commands.options import ElementOption, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.comparison.line_update import (
    MeasuredPassage,
    begin_estimate,
    build_updated_line,
    describe_update,
    judge_held_out,
    measure_dropper_heights,
    update_by_elasticity,
    update_by_modes,
    update_by_passage,
)
from pantocheck.conformance.comparison.static_record import StaticRecord, read_static_record
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.records.record_reading import open_record
from pantocheck.conformance.results.comparison_format import StaticValue
from pantocheck.conformance.results.identified_modes import read_modes
from pantocheck.conformance.results.line_update_format import HeldOutValue, LineUpdate
from pantocheck.conformance.runs.record_folder import find_record_mismatch, read_case_record


def line_update_command(
    line: Annotated[str, typer.Argument(help="Line file, or id or path of a case.", autocompletion=complete_case)],
    out: Annotated[Path, typer.Option(help="Line file to write; NAME.covariance.json is written beside it.")],
    heights: Annotated[Path | None, typer.Option(help="Static record of the heights of the contact wire.")] = None,
    elasticity: Annotated[Path | None, typer.Option(help="Static record of elasticities.")] = None,
    modes: Annotated[Path | None, typer.Option(help="modes.json of `pantocheck drop identify`.")] = None,
    passages: Annotated[
        list[Path] | None, typer.Option(help="Sidecar of a recorded passage, with its case; may be repeated.")
    ] = None,
    hold_out: Annotated[
        Path | None, typer.Option(help="Sidecar of the passage that judges the line, and takes no other part.")
    ] = None,
    element: ElementOption = 0.5,
    folders: CasesOption = None,
) -> CommandOutput:
    """Write the line as built, from measurements.

    The properties of the line are estimated together, with their covariance.

    The tolerances of the line ([tolerance], or 1 %, damping 20 %) are the prior. The verdict is that of the held-out
    passage alone: its bands lie within the uncertainty of the updated line, at a level of 1 %.

    Example: pantocheck line update my-line.toml --heights h.toml --elasticity e.toml --modes modes.json --passages
    a.toml --hold-out c.toml --out as-built.toml
    """
    if not (heights or elasticity or modes or passages):
        raise InputError("line update", "has no measurement", "Give --heights, --elasticity, --modes or --passages.")
    stated, catalogue = read_line(line), open_catalogue(folders or ())
    survey = _read_statics(heights, stated, "contact_wire_height")
    statics = _read_statics(elasticity, stated, "elasticity")
    recorded = [_read_passage(path, stated, catalogue) for path in passages or ()]
    judge = None if hold_out is None else _read_passage(hold_out, stated, catalogue)
    check_writable(out.parent)
    estimate, base = begin_estimate(stated), stated
    tasks = sum(data is not None for data in (survey, statics, modes, judge)) + len(recorded)
    with follow_steps("line update", tasks) as progress:
        levels = None
        if survey is not None:
            progress.begin_task("heights")
            levels = measure_dropper_heights(stated, survey)
            base = validate_model(build_updated_line(stated, estimate, levels), LineFile, "surveyed line")
        if modes is not None:
            progress.begin_task("modes")
            estimate = update_by_modes(estimate, base, read_modes(modes), element, modes.name)
        if statics is not None:
            progress.begin_task("elasticity")
            estimate = update_by_elasticity(estimate, base, statics, element)
        for passage in recorded:
            progress.begin_task(passage.name)
            estimate = update_by_passage(estimate, base, passage)
        rows, probability = tuple[HeldOutValue, ...](), None
        if judge is not None:
            progress.begin_task(judge.name)
            rows, probability = judge_held_out(estimate, base, judge)
    tree = build_updated_line(stated, estimate, levels)
    validate_model(tree, LineFile, "updated line")
    update = describe_update(estimate, stated, levels, rows, probability)
    head = "# Written by `pantocheck line update`.\n"
    write_atomically(out, (head + tomli_w.dumps(tree)).encode())
    data = out.with_suffix(".covariance.json")
    write_model(data, update)
    return _describe(update, [out, data])


def _read_statics(path: Path | None, line: LineFile, name: StaticValue) -> StaticRecord | None:
    """Static record of a line with a column."""
    if path is None:
        return None
    record = read_static_record(path, line.geometry)
    if name not in record.values:
        raise InputError(f"record '{record.source}'", f"has no {name.replace('_', ' ')}", "Give another record.")
    return record


def _read_passage(path: Path, line: LineFile, catalogue: Catalogue) -> MeasuredPassage:
    """Recorded passage of a case on the line.

    Raises:
        InputError: The record names no case, or one on another line.
    """
    where, name = f"passage '{path.name}'", open_record(path).case
    if name is None:
        raise InputError(where, "names no case", "Give the id of its case in the sidecar.")
    (case, *_) = select_cases([name], (), catalogue)
    if case.line != line:
        raise InputError(where, f"is of case {name}, which is on another line", "Give the line of the passages.")
    record = read_case_record(path, case)[0]
    if (mismatch := find_record_mismatch(case, record)) is not None:
        raise InputError(where, mismatch, "Give a record of the case.")
    return MeasuredPassage(path.stem, case, record)


def _describe(update: LineUpdate, files: list[Path]) -> CommandOutput:
    """Verdict, properties with their intervals, and the held-out passage."""
    table = build_table("property", "factor", "95 % interval", right=("factor", "95 % interval"))
    for row in update.properties:
        name = row.name.replace("_", " ") + ("" if row.determined else " (not determined)")
        table.add_row(escape_text(name), f"{row.factor:.4f}", f"{row.low_95:.4f} to {row.high_95:.4f}")
    bands = build_table("held-out passage", "measured", "updated line", "line as stated", "line +-", right=())
    for value in update.held_out:
        numbers = (value.measured, value.predicted, value.stated, 1.96 * value.line_std)
        bands.add_row(escape_text(f"{value.quantity}, pantograph {value.pantograph}"), *map(format_number, numbers))
    if update.probability is None:
        text = "no held-out passage judges the line"
    else:
        text = f"the held-out passage has a probability of {update.probability:.2g} on the updated line"
    return CommandOutput(
        style_verdict(update.verdict) + escape_text(f" {text}"),
        update,
        [table, *([bands] if update.held_out else [])],
        files=files,
        exit_code=EXIT_CODES[update.verdict],
    )
