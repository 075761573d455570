"""Process of a program: exchange of lines over pipes with a time limit, and end of all its child processes."""

import contextlib
import os
import queue
import shlex
import shutil
import signal
import subprocess
import threading
import time
import uuid
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import IO

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import KILL, adopt_orphans, end_with_parent, list_user_variables
from pantocheck.conformance.core.texts import DocumentationPage

LONGEST_LINE = 1_000_000
"""Largest size of an answer [bytes]; numbers belong in record files."""
MOST_OUTPUT = 10_000_000
"""Largest size of the whole standard output of the program of a case [bytes]."""
ERROR_TAIL = 4000
"""Size of the end of standard error that a failure quotes [bytes]."""
END_LIMIT = 5.0
"""Time limit of a program to end by itself [s]."""
MARK = "PANTOCHECK_PROGRAM"
"""Environment variable that marks the children of a program, also in other sessions."""


class ProgramFailed(Exception):
    """A program ended early, exceeded its time limit or wrote too much: its case cannot be graded."""


class Program:
    """Running program; the end of its context ends it with all its children.

    Args:
        arguments: Program and arguments; no shell interprets them.
        folder: Working folder.
        most_output: Largest size of its whole standard output [bytes].

    Raises:
        ProgramFailed: The program cannot be started.
    """

    def __init__(self, arguments: Sequence[str], folder: Path, most_output: int = MOST_OUTPUT) -> None:
        self._mark = uuid.uuid4().hex
        self._adoption = adopt_orphans()
        self._adoption.__enter__()
        try:
            self._process = subprocess.Popen(
                arguments,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                cwd=folder,
                env={**list_user_variables(), MARK: self._mark, "TMPDIR": str(folder)},
                start_new_session=True,
                # One call of the C library between fork and exec, which takes no lock of another thread.
                preexec_fn=end_with_parent if os.name == "posix" else None,  # noqa: PLW1509
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        except OSError as error:
            self._adoption.__exit__(None, None, None)
            raise ProgramFailed(f"cannot be started ({error.strerror})") from None
        self._lines: queue.SimpleQueue[bytes | ProgramFailed | None] = queue.SimpleQueue()
        self._errors = bytearray()
        # A thread per pipe: no pipe can block another one.
        self._readers = [
            threading.Thread(target=_read_lines, args=(self._process.stdout, self._lines, most_output), daemon=True),
            threading.Thread(target=_keep_tail, args=(self._process.stderr, self._errors), daemon=True),
        ]
        for reader in self._readers:
            reader.start()

    def __enter__(self) -> "Program":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._end()

    def send(self, line: bytes) -> None:
        """Send one line of text without waiting; if the program does not read it, `read_line` misses the answer."""
        threading.Thread(target=self._write, args=(line,), daemon=True).start()

    def _write(self, line: bytes) -> None:
        if self._process.stdin is not None:
            # The end of the program is reported, not the broken pipe.
            with contextlib.suppress(OSError, ValueError):
                self._process.stdin.write(line + b"\n")
                self._process.stdin.flush()

    def ask(self, line: bytes, limit: float) -> bytes:
        """Send a short line, which the pipe holds, and read the answer; limit and errors as in `read_line`."""
        self._write(line)
        return self.read_line(limit)

    def read_line(self, limit: float) -> bytes:
        """Read the next line of the standard output.

        Args:
            limit: Time limit [s].

        Raises:
            ProgramFailed: No line within the time limit.
        """
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            raise ProgramFailed(f"gave no answer within {limit:g} s{self._quote_errors()}") from None
        if isinstance(line, ProgramFailed):
            raise line
        if line is None:
            raise ProgramFailed(f"{self._describe_end()} before it answered{self._quote_errors()}")
        return line

    def refuse_late_failure(self) -> None:
        """Refuse the answer of a program that fails after it.

        Raises:
            ProgramFailed: It ended with an exit code that is not 0, or by a signal.
        """
        if self._process.returncode:
            raise ProgramFailed(f"{self._describe_end()} after its answer 'delivered'{self._quote_errors()}")

    def read_late_lines(self) -> list[bytes]:
        """Read the lines after the last answer of a program that has ended."""
        lines = []
        self._readers[0].join(END_LIMIT)
        with contextlib.suppress(queue.Empty):
            while isinstance(line := self._lines.get_nowait(), bytes):
                lines.append(line)
        return lines

    def wait_for_end(self, limit: float | None = None) -> bool:
        """Wait for the end of the program, by default `END_LIMIT` [s]; False if it still runs."""
        try:
            self._process.wait(END_LIMIT if limit is None else limit)
        except subprocess.TimeoutExpired:
            return False
        return True

    def _describe_end(self) -> str:
        if not self.wait_for_end(1.0):
            return "closed its output"
        code = self._process.returncode
        if code >= 0:
            return f"ended with exit code {code}"
        with contextlib.suppress(ValueError):
            return f"was ended by {signal.Signals(-code).name}"
        return f"was ended by signal {-code}"

    def _quote_errors(self) -> str:
        self._readers[1].join(0.5)
        lines = [" ".join(line.split()) for line in self._errors.decode("utf-8", "replace").splitlines()]
        shown = ["".join(c if c.isprintable() else "?" for c in line) for line in lines if line]
        if not shown:
            return ""
        before = f"; before it: {' '.join(shown[:-1])[-300:]}" if shown[1:] else ""
        return f"; end of its standard error: {shown[-1][-300:]}{before}"

    def _end(self) -> None:
        if os.name == "posix":
            for _ in range(10):
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(self._process.pid, KILL)
                children = _find_marked(self._mark)
                for child in children:
                    with contextlib.suppress(ProcessLookupError, PermissionError):
                        os.kill(child, KILL)
                if not children:
                    break
                time.sleep(0.02)
        else:
            with contextlib.suppress(OSError, subprocess.SubprocessError):
                subprocess.run(
                    ["taskkill", "/T", "/F", "/PID", str(self._process.pid)],
                    capture_output=True, check=False, timeout=END_LIMIT,
                )  # fmt: skip
            self._process.kill()
        self.wait_for_end()
        self._adoption.__exit__(None, None, None)
        for reader in self._readers:
            reader.join(END_LIMIT)
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            with contextlib.suppress(OSError, ValueError):
                if pipe is not None:
                    pipe.close()


def _find_marked(mark: str) -> list[int]:
    """Running processes with the mark in their environment; on Linux only."""
    processes = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if f"{MARK}={mark}".encode() in path.read_bytes():
                processes.append(int(path.parent.name))
    return processes


def _read_lines(stream: IO[bytes], lines: "queue.SimpleQueue[bytes | ProgramFailed | None]", most: int) -> None:
    """Put every line into the queue; then None, or `ProgramFailed` after too much output or an incomplete line."""
    line, total = bytearray(), 0
    while chunk := os.read(stream.fileno(), 65536):
        total += len(chunk)
        *whole, rest = chunk.split(b"\n")
        for part in whole:
            lines.put(bytes(line) + part)
            line.clear()
        line += rest
        if len(line) > LONGEST_LINE or total > most:
            size = f"a line of more than {LONGEST_LINE}" if len(line) > LONGEST_LINE else f"more than {most}"
            lines.put(ProgramFailed(f"wrote {size} bytes to its standard output: numbers belong in record files"))
            return
    lines.put(ProgramFailed(f"ended in the middle of a line, after {bytes(line[-60:])!r}") if line else None)


def _keep_tail(stream: IO[bytes], tail: bytearray) -> None:
    while chunk := os.read(stream.fileno(), 65536):
        tail += chunk
        del tail[:-ERROR_TAIL]


# Argument list of a program from the text after `command:`, without a shell.
ESCAPE = "" if os.name == "nt" else "\\"
"""Character that takes the meaning from the next one; on Windows backslashes separate folders."""
INTERPRETERS = {".py": "python", ".m": "octave", ".jl": "julia"}
"""Beginning of the name of the interpreter of each kind of script. Other programs may find a script elsewhere."""


def split_arguments(text: str, base: Path) -> tuple[str, ...]:
    """Split a command by the quoting rules of a shell, without expansions, and resolve file names.

    An argument that names an existing file becomes an absolute path, because the program runs in a new working folder.

    Args:
        text: Text after `command:`.
        base: Base folder of relative file names.

    Raises:
        InputError: There is no command, a quote is not closed, or there is no such program or script.
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
    script = next((Path(part) for part in parts[1:] if not part.startswith("-")), Path())
    interpreter = INTERPRETERS.get(script.suffix)
    if interpreter and Path(program).name.startswith(interpreter) and not _is_file(base / script):
        hint = f"Check the path; {DocumentationPage.SYSTEMS} shows adapters to start from."
        raise InputError(where, f"there is no file {script.name} in {(base / script).resolve().parent}", hint)
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
