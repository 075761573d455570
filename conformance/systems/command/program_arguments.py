"""Argument list of a program from the text after `command:`, without a shell."""

import os
import shlex
import shutil
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError

ESCAPE = "" if os.name == "nt" else "\\"
"""Character that takes the meaning from the next one; on Windows backslashes separate folders."""


def split_arguments(text: str, base: Path) -> tuple[str, ...]:
    """Split a command by the quoting rules of a shell, without expansions, and resolve file names.

    An argument that names an existing file becomes an absolute path, because the program runs in a new working folder.

    Args:
        text: Text after `command:`.
        base: Base folder of relative file names.

    Raises:
        InputError: There is no command, a quote is not closed, or there is no such program.
    """
    where, hint = f"system 'command:{text}'", "Write e.g. --system 'command:python3 adapter.py'."
    try:
        words = shlex.shlex(text, posix=True, punctuation_chars=False)
        words.whitespace_split, words.commenters = True, ""
        words.escape = ESCAPE
        parts = list(words)
    except ValueError as error:
        raise InputError(where, f"cannot be split into arguments ({error})", hint) from None
    if not parts or "\0" in text:
        raise InputError(where, "the command is empty", hint)
    has_folder = Path(parts[0]).name != parts[0]
    program = shutil.which((base / parts[0]).resolve() if has_folder and _is_file(base / parts[0]) else parts[0])
    if program is None:
        raise InputError(where, f"there is no executable program {parts[0]!r}", hint)
    # Links are kept: a virtual environment depends on the link to its interpreter.
    return (
        os.path.abspath(program),
        *(str((base / part).resolve()) if _is_file(base / part) else part for part in parts[1:]),
    )


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # The name is too long for a file.
        return False
