"""The commands, each from its own file. What is heavy is imported by a command when it runs, so that help is quick."""

from typing import Annotated

import typer

from pantocheck.conformance.command_line.assess_command import assess
from pantocheck.conformance.command_line.cases_command import cases
from pantocheck.conformance.command_line.drop_command import drop
from pantocheck.conformance.command_line.fit_damping_command import fit_damping
from pantocheck.conformance.command_line.guard import guarded
from pantocheck.conformance.command_line.identify_command import identify
from pantocheck.conformance.command_line.run_command import run
from pantocheck.conformance.command_line.schema_command import schema
from pantocheck.conformance.command_line.self_test_command import self_test
from pantocheck.conformance.command_line.show_command import show
from pantocheck.conformance.command_line.simulate_command import simulate
from pantocheck.conformance.command_line.verify_command import verify

app = typer.Typer(
    name="pantocheck",
    help="Open conformance suite and reference simulator for pantograph-catenary interaction.",
    epilog="Exit codes: 0 pass, 1 not passed, 2 error or bad input, 130 interrupted.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

for command in (run, assess, cases, show, simulate, drop, identify, fit_damping, verify, schema, self_test):
    app.command()(guarded(command))


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
