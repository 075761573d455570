"""The commands. The file of a command is imported when the command runs, so that help is fast."""

from importlib import import_module
from types import ModuleType
from typing import Annotated, Any, cast

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from pantocheck.conformance.app.commands.guard import guard_command
from pantocheck.conformance.app.commands.output_settings import add_flags, list_given
from pantocheck.conformance.core.extras import refuse_missing_package

PANELS: dict[str, dict[str, str]] = {
    "judge": {
        "run": "Run and grade cases on a system; write a certificate.",
        "assess": "Assess a record by the rules of a profile.",
        "validate": "Validate a simulator for a line by a dossier.",
        "verify": "Verify a document: verdicts, pages, cases, signatures.",
    },
    "look": {
        "cases": "List the cases of library, folders and distributions.",
        "show": "Show inputs, limits and notes of a case.",
        "simulate": "Simulate a case and write its record.",
        "readings": "Grade a record or case under every documented reading.",
        "view": "Show a passage or mass drops as moving pictures.",
        "explore": "Change inputs by sliders in a browser and see the passage.",
    },
    "write": {
        "new": "Write a commented, valid input file to start from.",
        "check": "Check input files and report all their problems.",
        "describe": "Describe the channels of a measured file.",
        "sign": "Sign a certificate or results.",
    },
    "many": {
        "campaign": "Run cases with varied inputs; write a table.",
        "compare": "Compare records, results or systems.",
        "site": "Write a static site from many results.",
    },
    "line": {
        "line import": "Write a line file from tables of supports and droppers.",
        "line export": "Write a line as tables, or as FMU.",
        "line draw": "Draw a whole line to scale, in elevation and in plan.",
        "line statics": "Compare measured static values with those of a line.",
        "line update": "Write the line as built, from measurements.",
    },
    "pantograph": {
        "pantograph check": "Check an FMU as a pantograph: interface, response, energy.",
        "pantograph compare": "Compare measured responses with a pantograph.",
        "pantograph fit": "Fit a chain of lumped masses to measured responses.",
    },
    "drop": {
        "drop simulate": "Simulate the mass drops of a case as records.",
        "drop campaign": "Simulate drops of many masses, places and tensions.",
        "drop identify": "Identify the modes of a line from mass-drop records.",
        "drop fit": "Fit a damping model of a line to identified modes.",
        "drop compare": "Compare a recorded mass drop with its simulation.",
    },
    "runs": {
        "runs import": "Add measured runs to a collection.",
        "runs assess": "Assess every section of the lines of a collection.",
    },
    "system": {
        "system check": "Check the adapter of a simulator with short cases.",
        "system self-test": "Test the suite with faulty systems.",
        "system rig": "Run a line against a pantograph on a rig.",
    },
    "suite": {
        "doctor": "Show versions, extras, caches and folders.",
        "schema": "Print the JSON Schema of a file format.",
    },
}
"""Commands by panel of the help, each with its summary, which is the first line of its docstring, too."""

SHARED_FILES = {
    "run": ("assess",),
    "check": ("schema",),
    "line_file": ("line import", "line export", "line draw"),
    "measured_comparison": ("line statics", "pantograph compare", "drop compare"),
    "drop_simulate": ("drop campaign",),
    "drop_identify": ("drop fit",),
    "runs": ("runs import", "runs assess"),
    "system_self_test": ("system check", "system rig"),
}
"""Prefix of the names of files with several commands, each with its commands; another command has its own file."""

COMMANDS = {name: summary for commands in PANELS.values() for name, summary in commands.items()}
"""Summary of each command by its name; the words of a command in a group are separated by a space."""


OUTPUT_EPILOG = "Options of the output, for every command: see `pantocheck --help`."


class LazyGroup(TyperGroup):
    """Group of commands that knows their names and summaries, and imports a command when it is called."""

    prefix = ""
    """Words before the names of the commands, with a space behind them."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name, summary in COMMANDS.items():
            first, space, _ = name.removeprefix(self.prefix).partition(" ")
            if name.startswith(self.prefix):
                self.commands[first] = _build_group(first) if space else TyperCommand(first, short_help=summary)

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Replace the summary of the command by the command itself."""
        name, command, rest = super().resolve_command(ctx, args)
        full = f"{self.prefix}{name}"
        return name, load_command(full) if full in COMMANDS else command, rest

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write one line per command, in panels."""
        width = max(len(name) for name in COMMANDS)
        formatter.write("\n")
        for panel, commands in PANELS.items():
            shown = [name for name in commands if name.startswith(self.prefix)]
            if shown:
                formatter.write(f"{panel.capitalize()}:\n")
            for name in shown:
                formatter.write(f"  {name:{width}}  {commands[name]}\n")


def _build_group(word: str) -> LazyGroup:
    """Group of the commands whose names begin with a word."""
    group = type("LazyGroup", (LazyGroup,), {"prefix": f"{word} "})
    return cast(
        LazyGroup,
        group(name=word, help=f"Commands of the group `{word}`.", no_args_is_help=True, rich_markup_mode=None),
    )


def _import_command(name: str, name_in_code: str) -> ModuleType:
    """File of a command. Those that compute with the compiled kernels themselves need the extra `simulator`."""
    file = next((file for file, commands in SHARED_FILES.items() if name in commands), name_in_code)
    with refuse_missing_package(f"pantocheck {name}"):
        return import_module(f"pantocheck.conformance.app.commands.{file}_command")


def load_command(name: str) -> Any:
    """Command of a name, imported from its file, with the options of the output."""
    name_in_code = name.replace("-", "_").replace(" ", "_")
    function = getattr(guard_command(_import_command)(name, name_in_code), f"{name_in_code}_command")
    # Tables and JSON would slow the help down.
    execution = import_module("pantocheck.conformance.app.commands.command_output")
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name.rpartition(" ")[2], epilog=OUTPUT_EPILOG)(execution.build_executable(name, function))
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
