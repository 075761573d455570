"""The system that `--system` names."""

from importlib import import_module
from pathlib import Path

from pantocheck.conformance.errors import InputError
from pantocheck.conformance.systems import System


def system_named(text: str) -> System:
    """The system under test for `builtin` or `record:DIR`.

    Raises
    ------
    InputError : there is no such system
    """
    kind, _, rest = text.partition(":")
    if text == "builtin":
        # Compiled kernels are only loaded when they are used.
        system: System = import_module("pantocheck.conformance.systems.builtin").ReferenceSimulator()
        return system
    if kind == "record" and rest:
        from pantocheck.conformance.systems.record_folder import record_folder

        return record_folder(Path(rest))
    raise InputError(f"system '{text}'", "there is no such system", "Known are builtin and record:DIR .")
