"""`pantocheck view`: a passage of a case, a record or results, or the mass drops of a case, as moving pictures."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.options import SetOption
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.commands.readings_command import open_subject
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.drop_scene import build_drop_scene
from pantocheck.conformance.drops.drop_simulation import require_mass_drop
from pantocheck.conformance.execution.runner import identify_system
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.pages.report_writers import write_report
from pantocheck.conformance.pages.view_page import build_drop_view, build_view
from pantocheck.conformance.results.results_format import Results, SystemIdentity
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.reference_simulator import SimulatorWithMotion
from pantocheck.conformance.runs.system import Delivered


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
    """Show a passage or mass drops as moving pictures.

    A record without shapes of the wires has the force and the uplift alone. Nothing is judged: the exit code is 0.

    Examples:

    pantocheck view en50318-2002/250 --out 250.html

    pantocheck view report/results.json --out passages.html

    pantocheck view vovan2015/mass-drop/stand-in --out drops.html
    """
    if out.suffix != ".html":
        raise InputError("option --out", f"found '{out}'", "Give a name that ends with .html.")
    check_writable(out.parent)
    path, catalogue = Path(subject), open_catalogue(folders or [])
    if entry := catalogue.find_id(subject):
        case = load_entry(entry, parse_changes(changed or []))
        if case.file.mass_drop is not None:
            return _view_drops(case, out)
    results = read_results(path) if path.suffix == ".json" else _build_single(subject, changed or [], catalogue)
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


def _view_drops(case: Case, out: Path) -> CommandOutput:
    """Write the page of the mass drops of a case."""
    drops = len(require_mass_drop(case).drop)
    with follow_steps("mass drops", drops) as progress:
        scenes = []
        for number in range(1, drops + 1):
            scenes.append(build_drop_scene(case, number))
            progress.finish_task()
    shown = [scene for scene in scenes if scene is not None]
    if not shown:
        raise InputError(f"case '{case.id}'", "has no drop with a moving picture", "Leave out --kernel.")
    write_report(build_drop_view(case.file.title, shown), out)
    facts = {"cases": [case.id], "moving": len(shown)}
    return CommandOutput(escape_text(count_noun(len(shown), "mass drop")), facts, files=(out,))


def _build_single(subject: str, changed: list[str], catalogue: Catalogue) -> Results:
    """Results of one case that was simulated, or of one record."""
    simulator = SimulatorWithMotion()
    case, outcome = open_subject(subject, changed, catalogue, simulator.run)
    result = grade_case(case, outcome, "secondary")
    identity = identify_system(simulator)
    if isinstance(outcome, Delivered) and outcome.digest is not None:
        identity = SystemIdentity(name=Path(subject).name, version="", kind="record")
    return build_results([result], identity, "secondary", utc_now())
