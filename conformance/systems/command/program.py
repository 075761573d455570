"""A program at the other end of three pipes: lines with a time limit, and an end that is always reached."""

import contextlib
import os
import queue
import signal
import subprocess
import threading
import time
import uuid
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import IO

LONGEST_LINE = 1_000_000
"""Bytes of an answer: numbers belong into record files."""
MOST_OUTPUT = 10_000_000
"""Bytes of standard output in all."""
LAST_WORDS = 4000
"""Bytes of standard error that are kept for the reason of a failure."""
PATIENCE = 5.0
"""Time a program has to end by itself [s]."""
MARK = "PANTOCHECK_PROGRAM"
"""Environment variable by which the children of a program are known, wherever they have moved."""


class ProgramFailed(Exception):
    """A program died, was late or talked nonsense: its case cannot be graded, and the others must go on."""


class Program:
    """A running program; leaving its context ends it with all its children.

    Parameters
    ----------
    arguments
        Program and arguments, never seen by a shell.
    folder
        Its working folder.

    Raises
    ------
    ProgramFailed
        It cannot be started.
    """

    def __init__(self, arguments: Sequence[str], folder: Path) -> None:
        self._mark = uuid.uuid4().hex
        try:
            self._process = subprocess.Popen(
                arguments,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                cwd=folder,
                env={**os.environ, MARK: self._mark, "TMPDIR": str(folder)},
                start_new_session=True,
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        except OSError as error:
            raise ProgramFailed(f"cannot be started ({error.strerror})") from None
        self._lines: queue.SimpleQueue[bytes | ProgramFailed | None] = queue.SimpleQueue()
        self._errors = bytearray()
        # Each pipe has a thread: none of them can block the others, whatever the program reads or writes.
        self._readers = [
            threading.Thread(target=_read_lines, args=(self._process.stdout, self._lines), daemon=True),
            threading.Thread(target=_keep_tail, args=(self._process.stderr, self._errors), daemon=True),
        ]
        for reader in self._readers:
            reader.start()

    def __enter__(self) -> "Program":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._end()

    def send(self, line: bytes) -> None:
        """Send one line; a program that does not read is found out by its missing answer."""
        threading.Thread(target=self._write, args=(line,), daemon=True).start()

    def _write(self, line: bytes) -> None:
        if self._process.stdin is not None:
            # The reason of a broken pipe is what the program leaves behind, not the pipe.
            with contextlib.suppress(OSError, ValueError):
                self._process.stdin.write(line + b"\n")
                self._process.stdin.flush()

    def line(self, limit: float) -> bytes:
        """The next line of its standard output.

        Parameters
        ----------
        limit : float
            Time to wait for it [s].

        Raises
        ------
        ProgramFailed
            None came.
        """
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            raise ProgramFailed(f"gave no answer within {limit:g} s{self._last_words()}") from None
        if isinstance(line, ProgramFailed):
            raise line
        if line is None:
            raise ProgramFailed(f"{self._how_it_ended()} before it answered{self._last_words()}")
        return line

    def ended(self, patience: float | None = None) -> bool:
        """Wait until it ends by itself, for `PATIENCE` if nothing else is said; whether it does."""
        try:
            self._process.wait(PATIENCE if patience is None else patience)
        except subprocess.TimeoutExpired:
            return False
        return True

    def _how_it_ended(self) -> str:
        if not self.ended(1.0):
            return "closed its output"
        code = self._process.returncode
        if code >= 0:
            return f"ended with exit code {code}"
        with contextlib.suppress(ValueError):
            return f"was ended by {signal.Signals(-code).name}"
        return f"was ended by signal {-code}"

    def _last_words(self) -> str:
        self._readers[1].join(0.5)
        text = " ".join(self._errors.decode("utf-8", "replace").split())
        shown = "".join(c if c.isprintable() else "?" for c in text)
        return f"; its last words: {shown[-300:]}" if shown else ""

    def _end(self) -> None:
        if os.name == "posix":
            for _ in range(10):
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(self._process.pid, signal.SIGKILL)
                strays = _marked(self._mark)
                for stray in strays:
                    with contextlib.suppress(ProcessLookupError, PermissionError):
                        os.kill(stray, signal.SIGKILL)
                if not strays:
                    break
                time.sleep(0.02)
        else:
            with contextlib.suppress(OSError, subprocess.SubprocessError):
                subprocess.run(
                    ["taskkill", "/T", "/F", "/PID", str(self._process.pid)],
                    capture_output=True, check=False, timeout=PATIENCE,
                )  # fmt: skip
            self._process.kill()
        self.ended()
        for reader in self._readers:
            reader.join(PATIENCE)
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            with contextlib.suppress(OSError, ValueError):
                if pipe is not None:
                    pipe.close()


def _marked(mark: str) -> list[int]:
    """Living processes that carry the mark in their environment; Linux alone can tell."""
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if f"{MARK}={mark}".encode() in path.read_bytes():
                found.append(int(path.parent.name))
    return found


def _read_lines(stream: IO[bytes], lines: "queue.SimpleQueue[bytes | ProgramFailed | None]") -> None:
    """Hand over lines as they come; None at the end, or a `ProgramFailed` at too much or at half a line."""
    line, total = bytearray(), 0
    while chunk := os.read(stream.fileno(), 65536):
        total += len(chunk)
        *whole, rest = chunk.split(b"\n")
        for part in whole:
            lines.put(bytes(line) + part)
            line.clear()
        line += rest
        if len(line) > LONGEST_LINE or total > MOST_OUTPUT:
            what = f"a line of more than {LONGEST_LINE}" if len(line) > LONGEST_LINE else f"more than {MOST_OUTPUT}"
            lines.put(ProgramFailed(f"wrote {what} bytes to its standard output: numbers belong into record files"))
            return
    lines.put(ProgramFailed(f"ended in the middle of a line, after {bytes(line[-60:])!r}") if line else None)


def _keep_tail(stream: IO[bytes], tail: bytearray) -> None:
    while chunk := os.read(stream.fileno(), 65536):
        tail += chunk
        del tail[:-LAST_WORDS]
