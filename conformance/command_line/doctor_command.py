"""`pantocheck doctor`: report on the installation."""

import json
from itertools import groupby
from typing import Annotated

import typer

from pantocheck.conformance.command_line.console import build_table, console, escape_text
from pantocheck.conformance.command_line.environment_facts import DeclaredPackage, list_environment, list_requirements


def doctor_command(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, to attach to a report of a fault.")] = False,
) -> None:
    """Show versions, extras, caches and folders of this installation.

    Exit code 0: every dependency is installed in a sufficient version. Exit code 1: one is missing or too old. Packages
    of an extra may be missing.

    Example: pantocheck doctor --json > environment.json
    """
    facts, requirements = list_environment(), list_requirements()
    faulty = [requirement for requirement in requirements if not requirement.extra and requirement.state != "installed"]
    if as_json:
        packages = [
            {
                "name": requirement.name,
                "extra": requirement.extra,
                "lowest": requirement.lowest,
                "installed": requirement.installed,
                "state": requirement.state,
            }
            for requirement in requirements
        ]
        typer.echo(json.dumps({"environment": facts, "packages": packages}, indent=1))
    else:
        _print_report(facts, requirements)
    raise typer.Exit(1 if faulty else 0)


def _print_report(facts: dict[str, str], requirements: tuple[DeclaredPackage, ...]) -> None:
    output = console()
    table = build_table("fact", "value", unbroken=("fact",))
    for name, value in facts.items():
        table.add_row(name, escape_text(value))
    output.print(table)
    for extra, group in groupby(requirements, lambda requirement: requirement.extra):
        members = list(group)
        output.print()
        title = f"extra {extra}: {_describe_extra(extra, members)}" if extra else "packages of every installation"
        output.print(escape_text(title), soft_wrap=True)  # a title of the table would be as narrow as the table
        table = build_table("package", "installed", "lowest", "state")
        for member in members:
            table.add_row(member.name, member.installed or "-", member.lowest, member.state)
        output.print(table)


def _describe_extra(extra: str, members: list[DeclaredPackage]) -> str:
    """State of an extra, with the line that installs it."""
    if all(member.state == "installed" for member in members):
        return "complete"
    return f"not complete; pip install 'pantocheck[{extra}]'"
