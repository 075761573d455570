"""Run of a page as a reader does it: every block in its order, in a folder that holds the files of the clone.

A block `sh` runs in bash; a folder that it enters stays current. A comment `# exit code 1` behind a command states
an exit code other than 0.
A block `python` runs as in a notebook: all blocks of a page share their names.
A block whose first line is `# file: NAME` is written to this file of the current folder.
A block `output` shows lines of the output of the block before it. Lines may be left out, for which `...` stands,
and numbers may differ by one unit of their last digit.
"""

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from site_pages.page_blocks import Block

ROOT = Path(__file__).parents[2]
CLONE = ("examples", "reference_cases", "docs/ci", "README.md")
"""Files of the clone that pages name."""

SHELL = """
set -u
trap 'echo "$?" >> "$PAGE_CODES"' ERR
{commands}
pwd > "$PAGE_FOLDER"
"""
NUMBER = re.compile(r"[-+]?\d+(?:\.(\d+))?(?:[eE][-+]?\d+)?")


class BlockFault(Exception):
    """A block of a page does not run, or its output is not that of the page."""


@dataclass
class PageRun:
    """State of a run: folder, names of the Python blocks, and the output of the last block.

    Parameters
    ----------
    root : Path
        Folder with the files of the clone.
    """

    root: Path
    current: Path = field(init=False)
    names: dict[str, Any] = field(default_factory=lambda: {"__name__": "__main__"})
    output: str = ""

    def __post_init__(self) -> None:
        self.current = self.root

    def take(self, block: Block) -> None:
        """Run, write or compare a block; raises `BlockFault`."""
        if block.file is not None:
            (self.current / block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            self.output = self._run_python(block)
        elif block.runs:
            self.output = self._run_shell(block)
        elif block.language == "output":
            compare_output(block, self.output)

    def _run_python(self, block: Block) -> str:
        printed = io.StringIO()
        code = compile("\n" * (block.line - 1) + block.text, str(block.page), "exec")
        with contextlib.chdir(self.current), contextlib.redirect_stdout(printed):
            exec(code, self.names)
        return printed.getvalue()

    def _run_shell(self, block: Block) -> str:
        codes, folder = self.root / ".codes", self.root / ".folder"
        codes.write_text("")
        done = subprocess.run(
            ["bash", "-c", SHELL.format(commands=block.text)],
            cwd=self.current,
            env=build_environment() | {"PAGE_CODES": str(codes), "PAGE_FOLDER": str(folder)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            check=False,
        )
        expected = re.findall(r"# exit code (\d+)", block.text)
        if codes.read_text().split() != expected or "Traceback" in done.stdout:
            stated = f"exit codes {codes.read_text().split()}, expected {expected}"
            raise BlockFault(f"{block.page.name}:{block.line}: {stated}\n{block.text}\n{done.stdout}")
        self.current = Path(folder.read_text().strip())
        return done.stdout


def build_environment() -> dict[str, str]:
    """Environment of a reader with the active environment, in a terminal of 80 columns."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "COLUMNS": "80", "MPLBACKEND": "agg", "OMP_NUM_THREADS": "1", "NO_COLOR": "1"}


def copy_clone(folder: Path) -> None:
    """Copy the files of the clone that pages name."""
    for name in CLONE:
        source, target = ROOT / name, folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)


def compare_output(block: Block, output: str) -> None:
    """Compare the lines of a block with an output; every line must occur, in the order of the block."""
    printed = iter(output.splitlines())
    for line in block.text.splitlines():
        if line.strip() in ("", "..."):
            continue
        if not any(is_same_line(line, candidate) for candidate in printed):
            raise BlockFault(f"{block.page.name}:{block.line}: this line is not printed here: {line}\n{output}")


def is_same_line(shown: str, printed: str) -> bool:
    """Whether two lines have the same words; numbers may differ by one unit of the last digit that is shown."""
    first, second = shown.split(), printed.split()
    return len(first) == len(second) and all(map(_is_same_word, first, second))


def _is_same_word(shown: str, printed: str) -> bool:
    if shown == printed:
        return True
    if NUMBER.sub("#", shown) != NUMBER.sub("#", printed):
        return False
    pairs = zip(NUMBER.finditer(shown), NUMBER.finditer(printed), strict=True)
    return all(
        abs(float(one[0]) - float(other[0])) <= 1.01 * 10.0 ** -len(one[1] or "") if one[1] else one[0] == other[0]
        for one, other in pairs
    )
