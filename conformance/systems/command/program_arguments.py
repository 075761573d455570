"""The argument list of a program, from the text after `command:`. No shell ever sees it."""

import os
import shlex
import shutil
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError


def split_arguments(text: str, base: Path) -> tuple[str, ...]:
    """Split a command as a shell would, without its expansions, and find its files.

    A program runs in a working folder of its own, so an argument that names an existing file is made absolute.

    Parameters
    ----------
    text : str
        What follows `command:`.
    base : Path
        Folder that relative names are relative to.

    Raises
    ------
    InputError
        There is no command, a quote is not closed, or there is no such program.
    """
    where, hint = f"system 'command:{text}'", "Write e.g. --system 'command:python3 adapter.py'."
    try:
        words = shlex.shlex(text, posix=True, punctuation_chars=False)
        words.whitespace_split, words.commenters = True, ""
        if os.name == "nt":
            words.escape = ""  # the backslashes of its paths are no escapes
        parts = list(words)
    except ValueError as error:
        raise InputError(where, f"cannot be split into arguments ({error})", hint) from None
    if not parts or "\0" in text:
        raise InputError(where, "names no program", hint)
    program = parts[0] if not (base / parts[0]).is_file() or _bare(parts[0]) else str((base / parts[0]).resolve())
    found = shutil.which(program)
    if found is None:
        raise InputError(where, f"there is no program {parts[0]!r} that can be run", hint)
    # The name on the search path is kept as it is found: the link of a virtual environment is what makes it one.
    return (
        os.path.abspath(found),
        *(str((base / part).resolve()) if _is_file(base / part) else part for part in parts[1:]),
    )


def _bare(name: str) -> bool:
    return Path(name).name == name


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # too long for a name, which is then no file
        return False
