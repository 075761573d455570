"""`pantocheck explore`: a page on this machine whose sliders run the simulator."""

import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.options import SetOption, choose_train_case
from pantocheck.conformance.app.explorer.explore_server import ExploreServer
from pantocheck.conformance.app.explorer.explored_case import ExploredCase
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.input_changes import InputChange, parse_changes
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages.explore_page import build_explorer
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.results.exploration_format import Exploration
from pantocheck.conformance.runs.core_requirement import COMPILATION, needs_compilation, require_core


def explore_command(
    case: Annotated[
        str, typer.Argument(help="Id or path of one case, e.g. en50318-2002/250.", autocompletion=complete_case)
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for settings that are saved as cases and campaigns.", show_default="none"),
    ] = None,
    changed: SetOption = None,
    folders: CasesOption = None,
    port: Annotated[int, typer.Option(help="Port on this machine; 0: any free one.", min=0, max=65535)] = 0,
    browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser of this machine.")] = False,
) -> CommandOutput:
    """Change inputs by sliders in a browser and see the passage.

    The command prints the address of the page, which holds a secret, and answers it until Ctrl-C. Nothing is judged.

    Examples:

    pantocheck explore en50318-2002/250 --open

    pantocheck explore my-case.toml --out explored
    """
    require_core("explorer")
    server = ExploreServer(*open_explorer(case, tuple(changed or ()), tuple(folders or ()), out), port)
    typer.echo(f"{server.address}\nCtrl-C ends the explorer.", err=True)
    if browser:
        webbrowser.open(server.address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
    saved = count_noun(len(server.saved), "saved setting")
    return CommandOutput(escape_text(f"explorer ended, {saved}"), {"case": case}, files=tuple(server.saved))


def open_explorer(
    name: str, changed: tuple[str, ...], folders: tuple[Path, ...], out: Path | None
) -> tuple[ExploredCase, str, Path | None]:
    """Explored case, its page and its folder for saved settings.

    Raises:
        InputError: There is no such case with a train, a change is wrong, or the folder cannot be written.
    """
    if out is not None:
        check_writable(out)
    catalogue, standing = open_catalogue(folders), parse_changes(changed)

    def load(changes: Sequence[InputChange]) -> Case:
        kept = (change for change in standing if change.key not in {other.key for other in changes})
        return choose_train_case(name, (*kept, *changes), catalogue)

    explored = ExploredCase(load, name, folders, changed)
    exploration = Exploration(
        id=explored.case.id,
        title=explored.case.file.title,
        sliders=explored.sliders,
        can_save=out is not None,
        waiting=f"{COMPILATION}." if needs_compilation() else "",
    )
    return explored, render_html(build_explorer(exploration)), out
