"""Options that several commands share, and the choice of the case or line that they name."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError

from pantocheck.conformance.app.commands.cases_option import complete_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import LIBRARY, Catalogue
from pantocheck.conformance.cases.input_changes import InputChange
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.core.validation_messages import build_input_error
from pantocheck.conformance.execution.plan import Plan, read_plan, split_names
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.administration import read_administration
from pantocheck.conformance.results.report_files import DEFAULT_FORMATS, FILES, LANGUAGES

SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change an input of the case, its line or its pantographs; repeat the option for several.",
    ),
]
PantographOption = Annotated[
    list[str] | None,
    typer.Option(
        help="Pantograph file or FMU in place of the pantographs of the case; repeat it for several in running order."
    ),
]
LineOption = Annotated[
    str,
    typer.Option(help="Measured line: id of a case, or path of a case or line file.", autocompletion=complete_case),
]
ElementOption = Annotated[float, typer.Option(help="Element length [m].", min=0.05, max=5.0)]
ResponsesArgument = Annotated[
    list[Path],
    typer.Argument(help=f"Tables of measured responses, or their sidecars: {DocumentationPage.PANTOGRAPH_RESPONSE}."),
]
DropCaseArgument = Annotated[
    str, typer.Argument(help="Id or path of one case with a mass drop.", autocompletion=complete_case)
]
OutOption = Annotated[Path | None, typer.Option(help="Folder for the results.", show_default="report")]
FormatsOption = Annotated[
    str | None,
    typer.Option(
        help=f"Formats to write, separated by commas: {', '.join(FILES)}.",
        show_default=",".join(DEFAULT_FORMATS),
    ),
]
LanguageOption = Annotated[
    str | None,
    typer.Option(help=f"Language of certificate and summary: {', '.join(LANGUAGES)}.", show_default=LANGUAGES[0]),
]
TrustOption = Annotated[
    str | None,
    typer.Option(
        help="Lowest trust of limits that count: primary, secondary or provisional.", show_default="secondary"
    ),
]
DecisionOption = Annotated[
    str | None,
    typer.Option(
        metavar="RULE",
        help="Decision rule: simple, guarded, or shared-risk:P with the largest risk P of a wrong acceptance.",
        show_default="simple",
    ),
]
VerdictsOption = Annotated[
    str | None,
    typer.Option(
        help="Verdicts that decide: criteria (EN 50318), verification (converged solution, up to 50 Hz) or both.",
        show_default="criteria for builtin, both for any other system",
    ),
]
AcceptUnconfirmedOption = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help="System whose unconfirmed records may pass; repeat the option for several."),
]
BaselineOption = Annotated[Path | None, typer.Option(help="Earlier results.json; a value that drifts from it fails.")]
AdministrationOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="TOML file with issuer and number; `pantocheck new administration` writes one."),
]
ReportNumberOption = Annotated[
    str | None, typer.Option(metavar="TEXT", help="Number of the report; it replaces that of --administration.")
]
DriftOption = Annotated[
    float | None, typer.Option(help="Allowed drift of a value from the baseline [%].", show_default="1")
]


def read_stated_administration(file: Path | None, report_number: str | None) -> dict[str, str]:
    """Administrative data from a file, with the number of the report from the command line in place of its own."""
    stated = {} if file is None else read_administration(file).model_dump(exclude_none=True)
    return stated if report_number is None else {**stated, "report_number": report_number}


OPTIONS = {
    "drift_pct": "--drift",
    "decision": "--decision",
    "jobs": "--jobs",
    "language": "--language",
    "timeout_s": "--timeout",
    "trust": "--trust",
}
"""Options of the command line by their key in a plan, for messages."""


def build_options(plan: Path | None = None, formats: str | None = None, **options: object) -> Plan:
    """Combine the options of the command line, by their key in a plan, with those of a plan.

    An option that is not None replaces that of the plan; administrative data do so key by key.

    Raises:
        InputError: The plan cannot be read, or a value of the plan or of the command line is wrong.
    """
    if formats is not None:
        options["formats"] = split_names(formats)
    texts = {key: _state_option(value) for key, value in options.items()}
    base = {} if plan is None else read_plan(plan).model_dump(exclude_none=True)
    given = {key: value for key, value in texts.items() if value is not None}
    if isinstance(stated := given.pop("administration", None), dict) and stated:
        given["administration"] = base.get("administration", {}) | stated
    try:
        return Plan.model_validate(base | given)
    except ValidationError as error:
        problems = build_input_error(error, Plan, "command line").problems
        raise join_errors([InputError(_name_option(each.where), each.found, each.hint) for each in problems]) from None


def _state_option(value: object) -> object:
    """Value as in a plan: a path is a text, and a repeated option a tuple of texts; None if it is not repeated."""
    if isinstance(value, list):
        return tuple(map(str, value)) or None
    return str(value) if isinstance(value, Path) else value


def _name_option(where: str) -> str:
    """Option of the command line in place of the key of a plan."""
    key = where.removeprefix("command line, key ")
    return f"option {OPTIONS[key]}" if key in OPTIONS else where


def choose_case(
    name: str,
    accept: Callable[[Case], bool],
    kind: str,
    changes: Sequence[InputChange] = (),
    catalogue: Catalogue = LIBRARY,
) -> Case:
    """Find the only case that a name, glob or path selects and that is acceptable.

    Args:
        name: Id, glob or path.
        accept, kind: Condition on a case, and the same in words for the message.
        changes: Changed inputs.
        catalogue: Cases that can be selected.

    Raises:
        InputError: No case, or several cases, meet the condition.
    """
    cases = [case for case in select_cases([name], changes, catalogue) if accept(case)]
    if len(cases) != 1:
        ids = ", ".join(case.id for case in cases) or "none"
        raise InputError(f"case '{name}'", f"expected one case {kind}, found {ids}", "Give the id of one case.")
    return cases[0]


def choose_train_case(name: str, changes: Sequence[InputChange], catalogue: Catalogue = LIBRARY) -> Case:
    """Find the only case with a train; parameters as in `choose_case`."""
    return choose_case(name, lambda case: not case.is_static, "with a train", changes, catalogue)


def choose_drop_case(name: str, changes: Sequence[InputChange] = ()) -> Case:
    """Find the only case with a mass drop; parameters as in `choose_case`."""
    return choose_case(name, lambda case: case.file.mass_drop is not None, "with a [mass_drop] table", changes)


def read_line(name: str) -> LineFile:
    """Read the line of a line file, or the common line of the cases that an id or path selects."""
    if name.endswith(".toml") and "geometry" in read_toml(Path(name), "line"):
        return read_model(Path(name), LineFile, "line")
    cases = select_cases([name])
    if any(case.line != cases[0].line for case in cases):
        raise InputError(f"line '{name}'", f"names {len(cases)} cases with different lines", "Give the id of one case.")
    return cases[0].line
