"""The commands. The file of a command is imported when the command runs, so that help is fast."""

from importlib import import_module
from types import ModuleType
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from pantocheck.conformance.command_line.guard import guard_command
from pantocheck.conformance.command_line.output_settings import add_flags, list_given
from pantocheck.conformance.input_files.extras import refuse_missing_package

COMMANDS = {
    "run": "Run cases on a system, grade them, and write the results and the certificate.",
    "campaign": "Run cases with varied inputs, and write a table of all runs.",
    "assess": "Assess a simulated or measured record by the rules of a profile.",
    "validate": "Validate a simulator for a line by a dossier: the EN 50318 procedure in one certificate.",
    "cases": "List the cases of the library, of folders and of installed distributions.",
    "show": "Show the inputs, the limits and the notes of a case with their trust and source.",
    "new": "Write a commented, valid line, case, pantograph, response, administration or dossier file.",
    "describe": "Describe a measured file: channels, rates, ranges, gaps and suspicious contents.",
    "check": "Check input files and report all their problems at once.",
    "simulate": "Simulate a case and write its record.",
    "drop": "Simulate the mass drops of a case and write their records.",
    "drop-campaign": "Simulate a campaign of mass drops: every combination of masses, places and tensions.",
    "identify": "Identify frequencies, damping ratios and mode shapes from mass-drop records.",
    "fit-damping": "Fit a damping model of a line to identified modes.",
    "compare": "Compare records, results or systems with the first of them.",
    "compare-drop": "Compare a recorded mass drop with its simulation under one or more damping models.",
    "import-line": "Write a line file from tables of its supports and droppers.",
    "export-line": "Write the supports and droppers of a line as tables for a spreadsheet.",
    "compare-statics": "Compare elasticities and contact wire heights measured along a line with its model.",
    "compare-response": "Compare frequency responses measured at a pantograph head with its model.",
    "fit-pantograph": "Fit a chain of lumped masses to frequency responses measured at a pantograph head.",
    "check-adapter": "Check the adapter of a simulator with short cases.",
    "sign": "Sign a certificate or results.",
    "verify": "Verify a document: its verdicts, its pages, its cases and its signatures.",
    "site": "Write a static site from many results: systems against cases, and versions over time.",
    "guide": "Write the verification and validation guide: every number is computed now, by this version.",
    "doctor": "Show versions, extras, caches and folders of this installation.",
    "schema": "Print or write the JSON Schema of a file format, for editors and validators.",
    "self-test": "Test the suite with faulty systems: each fault must be detected.",
}
"""Name and summary of each command; the summary is the first line of its docstring, too."""


OUTPUT_EPILOG = "Options of the output, for every command: see `pantocheck --help`."


class LazyGroup(TyperGroup):
    """Group of commands that knows their names and summaries, and imports a command when it is called."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = {name: TyperCommand(name, short_help=summary) for name, summary in COMMANDS.items()}

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Replace the summary of the command by the command itself."""
        name, command, rest = super().resolve_command(ctx, args)
        return name, load_command(name) if name in COMMANDS else command, rest


def _import_command(name: str, name_in_code: str) -> ModuleType:
    """File of a command. Those that compute with the compiled kernels themselves need the extra `simulator`."""
    with refuse_missing_package(f"pantocheck {name}"):
        return import_module(f"pantocheck.conformance.command_line.{name_in_code}")


def load_command(name: str) -> Any:
    """Command of a name, imported from its file, with the options of the output."""
    name_in_code = f"{name.replace('-', '_')}_command"
    function = getattr(guard_command(_import_command)(name, name_in_code), name_in_code)
    # Tables and JSON would slow the help down.
    execution = import_module("pantocheck.conformance.command_line.command_execution")
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name, epilog=OUTPUT_EPILOG)(execution.build_executable(name, function))
    return get_command(single)


app = typer.Typer(
    name="pantocheck",
    cls=LazyGroup,
    help="Open conformance suite and reference simulator for pantograph-catenary interaction.",
    epilog="Exit codes: 0 pass, 1 not passed, 2 error or bad input, 130, 143 or 129 interrupted.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _print_version(requested: bool) -> None:
    if requested:
        metadata = import_module("importlib.metadata")  # a quarter of the time of the help
        typer.echo(f"pantocheck {metadata.version('pantocheck')}")
        raise typer.Exit


def _options(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
    **flags: bool,
) -> None:
    context.obj = list_given(flags)


app.callback()(add_flags(_options, "shown"))
