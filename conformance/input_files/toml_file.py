"""Reading a TOML file from a stranger."""

import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.validation_messages import build_input_error

MAX_TOML_BYTES = 5_000_000
"""Bytes of a TOML file; no line or case needs more, and a parser given gigabytes would hang."""

T = TypeVar("T", bound=BaseModel)


def read_model(path: Path, model: type[T], kind: str) -> T:
    """Read and check a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    model : type[T]
        What it must be.
    kind : str
        What it is called in messages, e.g. `reference line`.

    Raises
    ------
    InputError
        It cannot be read, is not TOML, or does not fit the model.
    """
    where = f"{kind} '{path.name}'"
    tree = read_toml(path, kind)
    try:
        return model.model_validate(tree)
    except ValidationError as error:
        raise build_input_error(error, model, where) from None


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Read a TOML file without checking what it holds; parameters and errors as in `read_model`."""
    where = f"{kind} '{path.name}'"
    try:
        if path.stat().st_size > MAX_TOML_BYTES:
            raise InputError(where, f"{path.stat().st_size} bytes", f"A {kind} has at most {MAX_TOML_BYTES} bytes.")
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(where, f"cannot be read from {path} ({error.strerror})", "Check the path.") from None
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not UTF-8 text", "Save the file as UTF-8.") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, f"is not valid TOML: {str(error)[:200]}", "Mend the line named; see toml.io.") from None
    except (ValueError, RecursionError):
        # Numbers of thousands of digits and tables nested thousands deep get past the grammar.
        raise InputError(where, "holds a number or a nesting that is too long to read", "Write it plainly.") from None
