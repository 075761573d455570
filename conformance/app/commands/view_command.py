"""`pantocheck view`: the passage of a case, a record or results as a moving picture."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.options import SetOption
from pantocheck.conformance.app.commands.readings_command import open_subject
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.execution.runner import identify_system
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.pages.report_writers import write_report
from pantocheck.conformance.pages.view_page import build_view
from pantocheck.conformance.results.results_format import Results, SystemIdentity
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.reference_simulator import FilmingSimulator


def view_command(
    subject: Annotated[
        str,
        typer.Argument(
            metavar="CASE|RECORD|RESULTS",
            help="Id or path of a case, which is simulated; a record whose sidecar names its case; or results.json.",
            autocompletion=complete_case,
        ),
    ],
    out: Annotated[Path, typer.Option(help="Page to write: NAME.html.")],
    changed: SetOption = None,
    folders: CasesOption = None,
) -> CommandOutput:
    """Show a passage as a moving picture in a page.

    A record has the force and the uplift alone: it holds no shapes of the wires. Nothing is judged: the exit code is 0.

    Examples:

    pantocheck view en50318-2002/250 --out 250.html

    pantocheck view report/results.json --out passages.html
    """
    if out.suffix != ".html":
        raise InputError("option --out", f"found '{out}'", "Give a name that ends with .html.")
    check_writable(out.parent)
    path = Path(subject)
    results = read_results(path) if path.suffix == ".json" else _build_single(subject, changed or [], folders or [])
    shown = sum(bool(case.motion or case.traces) for case in results.cases)
    if not shown:
        reason = next((case.reason for case in results.cases if case.reason), "has no passage")
        raise InputError(f"'{subject}'", reason, "Give a case or a record with a contact force.")
    write_report(build_view(results), out)
    moving = sum(case.motion is not None for case in results.cases)
    conclusion = f"{count_noun(shown, 'passage')}, {moving} with moving wires"
    return CommandOutput(
        escape_text(conclusion),
        {"cases": [case.id for case in results.cases], "moving": moving},
        files=(out,),
    )


def _build_single(subject: str, changed: list[str], folders: list[Path]) -> Results:
    """Results of one case that was simulated, or of one record."""
    simulator = FilmingSimulator()
    case, outcome = open_subject(subject, changed, open_catalogue(folders), simulator.run)
    result = grade_case(case, outcome, "secondary")
    identity = identify_system(simulator)
    if result.line_shape is None:
        identity = SystemIdentity(name=Path(subject).name, version="", kind="record")
    return build_results([result], identity, "secondary", utc_now())
