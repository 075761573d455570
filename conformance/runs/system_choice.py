"""Choice of the system under test by the option `--system`."""

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any, cast

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.runs.system import System

TIMEOUT_S = 600.0
"""Default time limit of a program for a case [s]."""


def choose_system(text: str, timeout_s: float = TIMEOUT_S) -> System:
    """Choose the system under test: `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.

    Args:
        text: Value of `--system`.
        timeout_s: Time limit of a program for a case [s].

    Raises:
        InputError: There is no such system.
    """
    kind, _, rest = text.partition(":")
    if text == "builtin":
        # Only the reference simulator needs the compiled kernels.
        system: System = import_module("pantocheck.conformance.runs.reference_simulator").ReferenceSimulator()
        return system
    if kind == "record" and rest:
        from pantocheck.conformance.runs.record_folder import open_record_folder

        return open_record_folder(Path(rest))
    if kind == "command":
        from pantocheck.conformance.runs.command_system import parse_command

        return parse_command(rest, Path(), timeout_s)
    raise InputError(
        f"system '{text}'",
        "there is no such system",
        "Choose builtin, record:DIR or command:PROGRAM ARGUMENTS.",
    )


def use_threads(system: System, threads: int) -> System:
    """System that runs a case on several threads; only the reference simulator can."""
    if system.kind != "builtin":
        return system
    threaded: System = replace(cast(Any, system), threads=threads)
    return threaded
