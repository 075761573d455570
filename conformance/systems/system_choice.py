"""The system that `--system` names."""

from importlib import import_module
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.systems.system import System

TIMEOUT_S = 600.0
"""Time a program may take for a case [s], if nothing else is said."""


def choose_system(text: str, timeout_s: float = TIMEOUT_S) -> System:
    """The system under test for `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.

    Parameters
    ----------
    text : str
        As `--system` takes it.
    timeout_s : float
        Time that a program may take for a case [s].

    Raises
    ------
    InputError
        There is no such system.
    """
    kind, _, rest = text.partition(":")
    if text == "builtin":
        # Compiled kernels are only loaded when they are used.
        system: System = import_module("pantocheck.conformance.systems.reference_simulator").ReferenceSimulator()
        return system
    if kind == "record" and rest:
        from pantocheck.conformance.systems.record_folder import open_record_folder

        return open_record_folder(Path(rest))
    if kind == "command":
        from pantocheck.conformance.systems.command.command_system import parse_command

        return parse_command(rest, Path(), timeout_s)
    raise InputError(
        f"system '{text}'", "there is no such system", "Known are builtin, record:DIR and command:PROGRAM ARGUMENTS ."
    )
