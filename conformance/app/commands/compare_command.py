"""`pantocheck compare`: records, results and systems side by side."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text
from pantocheck.conformance.app.commands.options import SetOption, choose_train_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.opened_run import write_comparison
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.comparison.compared_run import (
    RESULTS_FILE,
    ComparedRun,
    read_record_run,
    read_results_runs,
    simulate_run,
)
from pantocheck.conformance.comparison.run_comparison import add_scenes, compare_subjects
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pages.report_writers import remark_missing_formats
from pantocheck.conformance.pages.run_comparison_page import format_compared
from pantocheck.conformance.pages.words import name_pantograph
from pantocheck.conformance.results.comparison_format import RunComparison
from pantocheck.conformance.runs.system_choice import choose_system

SYSTEMS = ("builtin", "record:", "command:")


def compare_command(
    subjects: Annotated[
        list[str],
        typer.Argument(
            metavar="A B ...",
            help="Records, results.json files or their folders, or systems: builtin, record:DIR, command:PROGRAM.",
        ),
    ],
    case: Annotated[
        str | None, typer.Option(help="Compared case; required for systems.", autocompletion=complete_case)
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for comparison.json, .html, .pdf and .csv.", show_default="none")
    ] = None,
    changed: SetOption = None,
) -> CommandOutput:
    """Compare records, results or systems.

    Quantities stand side by side with their differences. Of records and systems, the forces are compared at the same
    positions: by band, by frequency (coherence), in each span and over the place in the span. Nothing is judged: the
    exit code is 0.

    Examples:

    pantocheck compare simulated.csv measured.csv --out comparison

    pantocheck compare builtin "command:python my_code.py" --case en50318-2002/250 --out comparison

    pantocheck compare report-1.0/results.json report-1.1/results.json
    """
    if len(subjects) < 2:
        raise InputError("compare", "names one subject only", "Give two or more records, results or systems.")
    simulated = _choose_simulated_case(subjects, case, changed)
    if out is not None:
        check_writable(out)
    runs = []
    for subject in subjects:
        with follow_steps(subject):
            runs.append(_load_subject(subject, simulated))
    comparison = compare_subjects(runs, simulated.id if simulated is not None else case)
    files = [] if out is None else write_comparison(add_scenes(comparison, runs), out)
    return CommandOutput(
        escape_text(" beside ".join(subject.name for subject in comparison.subjects)),
        comparison,
        [*_list_tables(comparison)],
        files=files,
        remarks=remark_missing_formats() if files else (),
    )


def _choose_simulated_case(subjects: list[str], case: str | None, changed: list[str] | None) -> Case | None:
    """Case that the systems run; None without a system."""
    if not any(subject.startswith(SYSTEMS) for subject in subjects):
        return None
    if case is None:
        raise InputError("compare", "names a system, but no case", "Name the case that it runs with --case.")
    return choose_train_case(case, parse_changes(changed or ()))


def _load_subject(text: str, case: Case | None) -> list[ComparedRun]:
    """Runs of one subject."""
    if case is not None and text.startswith(SYSTEMS):
        return [simulate_run(case, choose_system(text))]
    path = Path(text)
    if path.is_dir() or path.suffix == Path(RESULTS_FILE).suffix:
        return read_results_runs(path)
    return [read_record_run(path)]


def _list_tables(comparison: RunComparison) -> Iterator[RenderableType]:
    """One table per case and pantograph; quantities with several numbers are left to the files."""
    names = [subject.name for subject in comparison.subjects]
    for case in comparison.cases:
        for note in case.notes:
            yield escape_text(note)
        for owner in case.owners:
            rows = [row for row in owner.quantities if not any(isinstance(value, tuple) for value in row.values)]
            if not rows:
                continue
            title = ", ".join(filter(None, (case.id, name_pantograph(owner.number))))
            table = build_table("quantity", *names, title=title, unbroken=("quantity",), right=names)
            for row in rows:
                table.add_row(escape_text(row.name), *(escape_text(format_compared(row, i)) for i in range(len(names))))
            yield table
            for agreement in owner.agreements:
                yield escape_text(
                    f"{agreement.subject}: correlation {agreement.correlation:.3f}, RMS of the difference "
                    f"{agreement.rms_difference_N:.3g} N up to {agreement.highest_Hz:g} Hz"
                )
            yield Text()
    yield Text("* beyond the joint nominal 95 % uncertainty of both values")
