"""Code blocks of a page: commands, programs, files to write and outputs to expect."""

import re
from dataclasses import dataclass
from pathlib import Path

FENCE = re.compile(
    r"^(?P<fence>`{3,})(?P<language>[\w{}-]*)[ \t]*\n(?P<text>.*?)^(?P=fence)[ \t]*$", re.DOTALL | re.MULTILINE
)
FILE = re.compile(r"^(?:#|//) file: (?P<name>\S+)\n")
PICTURE = re.compile(r"!\[[^\]]*\]\((?:\.\./)*generated/pictures/(?P<name>[^)\s]+)\)")

RUN_LANGUAGES = ("sh", "bash", "python")
"""Languages of the blocks that a reader runs."""


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: Path
    """Page that contains the block."""
    line: int
    """Number of its first line of text in the page, from 1."""
    language: str
    """Language behind the fence; empty if none is stated."""
    text: str
    """Text between the fences."""

    @property
    def file(self) -> str | None:
        """Name of the file that the block is, from its first line `# file: NAME`."""
        found = FILE.match(self.text)
        return found["name"] if found else None

    @property
    def runs(self) -> bool:
        """Whether a reader runs the block."""
        return self.language in RUN_LANGUAGES and self.file is None

    @property
    def first_line(self) -> str:
        """First line of the block, by which lists of blocks name it."""
        return self.text.split("\n", 1)[0]


def read_blocks(page: Path) -> list[Block]:
    """All fenced blocks of a page, in their order."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(page, text.count("\n", 0, found.start("text")) + 1, found["language"], found["text"])
        for found in FENCE.finditer(text)
    ]


def list_pictures(page: Path) -> list[str]:
    """Names of the pictures in `generated/pictures` that a page shows."""
    return [found["name"] for found in PICTURE.finditer(page.read_text(encoding="utf-8"))]
