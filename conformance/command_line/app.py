"""The commands, each from its own file. What is heavy is imported by a command when it runs, so that help is quick."""

from typing import Annotated

import typer

from pantocheck.conformance.command_line.assess_command import assess_command
from pantocheck.conformance.command_line.cases_command import cases_command
from pantocheck.conformance.command_line.drop_command import drop_command
from pantocheck.conformance.command_line.fit_damping_command import fit_damping_command
from pantocheck.conformance.command_line.guard import guard_command
from pantocheck.conformance.command_line.identify_command import identify_command
from pantocheck.conformance.command_line.run_command import run_command
from pantocheck.conformance.command_line.schema_command import schema_command
from pantocheck.conformance.command_line.self_test_command import self_test_command
from pantocheck.conformance.command_line.show_command import show_command
from pantocheck.conformance.command_line.simulate_command import simulate_command
from pantocheck.conformance.command_line.verify_command import verify_command

app = typer.Typer(
    name="pantocheck",
    help="Open conformance suite and reference simulator for pantograph-catenary interaction.",
    epilog="Exit codes: 0 pass, 1 not passed, 2 error or bad input, 130 interrupted.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

for command in (
    run_command,
    assess_command,
    cases_command,
    show_command,
    simulate_command,
    drop_command,
    identify_command,
    fit_damping_command,
    verify_command,
    schema_command,
    self_test_command,
):
    app.command(command.__name__.removesuffix("_command").replace("_", "-"))(guard_command(command))


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"pantocheck {version('pantocheck')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass
