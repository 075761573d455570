"""File modes.json: the list of identified modes that other tools read."""

from pathlib import Path

from pydantic import RootModel, TypeAdapter

from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.input_files.json_file import read_json, validate_json

MAX_MODES_BYTES = 50_000_000
"""Limit of the size of a modes.json [bytes]."""


class ModesFile(RootModel[tuple[Mode, ...]]):
    """Modes of all lines of an identification, each line by frequency."""


def read_modes(path: Path) -> tuple[Mode, ...]:
    """Read a modes.json.

    Raises
    ------
    InputError
        The file cannot be read, is not JSON, or is not a list of modes.
    """
    data = read_json(path, "modes", MAX_MODES_BYTES)
    hint = "Give the modes.json that `pantocheck identify` writes."
    return tuple(validate_json(data, TypeAdapter(list[Mode]), f"modes '{path.name}'", hint))
