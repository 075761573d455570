"""`pantocheck doctor`: report on the installation."""

from collections.abc import Iterator
from itertools import groupby

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from pantocheck.conformance.command_line.command_output import CommandOutput
from pantocheck.conformance.command_line.console import build_table, escape_text
from pantocheck.conformance.command_line.environment_facts import DeclaredPackage, list_environment, list_requirements


def doctor_command() -> CommandOutput:
    """Show versions, extras, caches and folders.

    Exit code 0: every dependency is installed in a sufficient version. Exit code 1: one is missing or too old. Packages
    of an extra may be missing.

    Example: pantocheck doctor --json > environment.json
    """
    facts, requirements = list_environment(), list_requirements()
    faulty = [requirement for requirement in requirements if not requirement.extra and requirement.state != "installed"]
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
    names = ", ".join(requirement.name for requirement in faulty)
    conclusion = Text(f"Missing or too old: {names}" if faulty else "Every dependency is installed.")
    return CommandOutput(
        conclusion,
        {"environment": facts, "packages": packages},
        [*_build_tables(facts, requirements)],
        exit_code=1 if faulty else 0,
    )


def _build_tables(facts: dict[str, str], requirements: tuple[DeclaredPackage, ...]) -> Iterator[RenderableType]:
    table = build_table("fact", "value", unbroken=("fact",))
    for name, value in facts.items():
        table.add_row(name, escape_text(value))
    yield table
    for extra, group in groupby(requirements, lambda requirement: requirement.extra):
        members = list(group)
        title = f"extra {extra}: {_describe_extra(extra, members)}" if extra else "packages of every installation"
        yield Padding(escape_text(title), (1, 0, 0, 0))
        table = build_table("package", "installed", "lowest", "state")
        for member in members:
            table.add_row(member.name, member.installed or "-", member.lowest, member.state)
        yield table


def _describe_extra(extra: str, members: list[DeclaredPackage]) -> str:
    """State of an extra, with the line that installs it."""
    if all(member.state == "installed" for member in members):
        return "complete"
    return f"not complete; pip install 'pantocheck[{extra}]'"
