"""`pantocheck validate`: the EN 50318 procedure for a dossier, with one certificate."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

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
from pantocheck.conformance.app.commands.options import (
    AdministrationOption,
    FormatsOption,
    LanguageOption,
    OutOption,
    ReportNumberOption,
    build_options,
    read_stated_administration,
)
from pantocheck.conformance.app.commands.progress_display import report_cases
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.dossier.dossier_reading import read_dossier
from pantocheck.conformance.dossier.validation import Validation
from pantocheck.conformance.execution.runner import RunInterrupted
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_all
from pantocheck.conformance.pages.scope_page import describe_steps, explain_step_missing, name_state
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.pages.words import read_words
from pantocheck.conformance.results.file_places import FilePlace, ReportPlaces
from pantocheck.conformance.results.procedure_format import Procedure
from pantocheck.conformance.results.report_files import check_formats
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.system_choice import choose_system


def validate_command(
    dossier: Annotated[Path, typer.Argument(metavar="DOSSIER.toml", help=f"Dossier: {DocumentationPage.VALIDATE}.")],
    out: OutOption = None,
    formats: FormatsOption = None,
    language: LanguageOption = None,
    administration: AdministrationOption = None,
    report_number: ReportNumberOption = None,
    jobs: Annotated[int, typer.Option(help="Number of reference models that run in parallel.", min=1, max=256)] = 1,
) -> CommandOutput:
    """Validate a simulator for a line by a dossier.

    Steps: pantograph model, static check of the line, simulation parameters, reference models, line tests, limits of
    validity. No PASS while a required step is missing.

    Example: pantocheck validate dossier.toml --out validation
    """
    options = build_options(
        out=out,
        formats=formats,
        language=language,
        administration=read_stated_administration(administration, report_number),
    )
    folder, report_formats = Path(options.out), check_formats(options.formats)
    content = read_dossier(dossier)
    system = choose_system(content.system, content.file.timeout_s)
    check_writable(folder)
    runs, interrupted = len(content.cases) + len(content.file.pair), 0
    try:
        with report_cases(runs, "running cases and line tests") as progress:
            results = Validation(content, system, folder, jobs, progress).run()
    except RunInterrupted as interruption:
        results, interrupted = interruption.results, interruption.exit_code
        typer.echo("Interrupted: the results of the finished steps are written.", err=True)
    results = results.model_copy(update={"administration": options.administration})
    files = write_all(results, folder, report_formats, ReportPlaces(FilePlace(dossier)), options.language)
    headline = escape_text(f" {build_headline(results)}")
    return CommandOutput(
        style_verdict(results.verdict) + headline,
        results,
        [] if results.procedure is None else [*_describe_results(results, results.procedure)],
        files=files,
        remarks=remark_missing_formats(options.formats),
        exit_code=interrupted or EXIT_CODES[results.verdict],
    )


def _describe_results(results: Results, procedure: Procedure) -> Iterator[RenderableType]:
    """Table of the steps, and their reasons."""
    table = build_table("step", "state", "verdict", "margin", "+-", right=("margin", "+-"))
    for step in procedure.steps:
        name = read_words()["procedure"][step.step]
        numbers = (
            format_number(step.margin, 3),
            format_number(step.uncertainty, 2),
        )
        table.add_row(name, name_state(step), style_verdict(step.verdict), *numbers)
    yield table
    lacking = dict.fromkeys(explain_step_missing(step, results.cases) for step in procedure.steps)
    for sentence in filter(None, (*lacking, *describe_steps(procedure), *_describe_cases(results))):
        yield indent_text(sentence)


def _describe_cases(results: Results) -> Iterator[str]:
    """Cases and pairs that do not pass, with their reasons."""
    for case in results.cases:
        rows = [row for row in case.criteria if row.verdict in ("fail", "skip", "error")]
        reasons = [case.reason] if case.reason else [f"{criterion_name(row)}: {row.reason}" for row in rows]
        if case.verdict not in ("pass", "info"):
            yield from (f"{case.id}: {reason}" for reason in reasons or [f"verdict {case.verdict}"])
