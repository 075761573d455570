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

BUILT = ("__pycache__", "*.egg-info", ".*_cache", "build", "dist", "report", "generated")
"""Patterns of files that are made in a clone and belong to no commit."""

PACKAGES = ("model", "conformance", "reference_cases", "templates")
"""Folders of the clone that are packages of `pantocheck`."""

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
    """State of a run: folder, names of the Python blocks, and the output of the last block."""

    root: Path
    """Folder with the files of the clone."""
    environment: dict[str, str]
    """Environment of the commands."""
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
        codes, folder = (self.root.parent / f"{self.root.name}.{name}" for name in ("codes", "folder"))
        codes.write_text("")
        done = subprocess.run(
            ["bash", "-c", SHELL.format(commands=block.text)],
            cwd=self.current,
            env=self.environment | {"PAGE_CODES": str(codes), "PAGE_FOLDER": str(folder)},
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


def start_page_run(root: Path, whole: bool) -> PageRun:
    """Run in a new folder with the files of the clone that pages name, or with a whole clone whose code counts."""
    environment = build_environment()
    if whole:
        copy_repository(root)
        packages = root.parent / f"{root.name}.packages"
        (packages / "pantocheck").mkdir(parents=True)
        for name in PACKAGES:
            (packages / "pantocheck" / name).symlink_to(root / name)
        environment["PYTHONPATH"] = str(packages)
        environment["GIT_CEILING_DIRECTORIES"] = str(root.parent)
    else:
        copy_files(root)
    return PageRun(root, environment)


def copy_files(root: Path) -> None:
    """Copy the files of the clone that pages name."""
    for name in CLONE:
        source, target = ROOT / name, root / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)


def copy_repository(root: Path) -> None:
    """Copy all files of the clone into a new repository with one commit."""
    built = shutil.ignore_patterns(*BUILT)
    root.mkdir(parents=True)
    for source in ROOT.iterdir():
        if source.is_dir() and source.name not in (".git", ".venv", ".hypothesis"):
            shutil.copytree(source, root / source.name, ignore=built)
        elif source.is_file() and source.name != ".git":
            shutil.copy(source, root)
    for arguments in ("init", "add .", "-c user.name=me -c user.email=me@example.org commit --quiet -m clone"):
        subprocess.run(["git", *arguments.split()], cwd=root, check=True, capture_output=True)


def compare_output(block: Block, output: str) -> None:
    """Compare the lines of a block with an output; every line must occur, in the order of the block.

    The output is compared word by word, because the program wraps its lines at the width of the terminal.
    """
    printed, start = output.split(), 0
    for line in block.text.splitlines():
        if line.strip() in ("", "..."):
            continue
        end = find_words(line.split(), printed, start)
        if end is None:
            raise BlockFault(f"{block.page.name}:{block.line}: this line is not printed here: {line}\n{output}")
        start = end


def find_words(shown: list[str], printed: list[str], start: int) -> int | None:
    """Index behind the first place of words at or after a start; `...` is any text, also of several words."""
    if "..." in shown:
        gap = shown.index("...")
        end = find_words(shown[:gap], printed, start)
        return None if end is None else find_words(shown[gap + 1 :], printed, end)
    for first in range(start, len(printed) - len(shown) + 1):
        if all(map(_is_same_word, shown, printed[first:])):
            return first + len(shown)
    return None


def _is_same_word(shown: str, printed: str) -> bool:
    """Whether two words are the same; numbers may differ by a unit of the last digit, and `...` is any text."""
    if shown == printed:
        return True
    if "..." in shown:
        return re.fullmatch(".*".join(map(re.escape, shown.split("..."))), printed) is not None
    if NUMBER.sub("#", shown) != NUMBER.sub("#", printed):
        return False
    ones, others = list(NUMBER.finditer(shown)), list(NUMBER.finditer(printed))
    return len(ones) == len(others) and all(
        abs(float(one[0]) - float(other[0])) <= 1.01 * 10.0 ** -len(one[1] or "") if one[1] else one[0] == other[0]
        for one, other in zip(ones, others, strict=True)
    )
