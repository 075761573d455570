"""Folders of pictures: written again only if their sources have changed; pages of documents as pictures."""

import hashlib
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parents[2]

SOURCES = ("conformance", "model", "reference_cases", "templates", "examples", "docs/site_pages")
"""Folders that decide the results of a command."""

RESOLUTION_PPI = 110
"""Resolution of a page of a document: its text is legible at a width of 800 pixels."""


def keep_pictures(folder: Path, text: str, write: Callable[[Path], None]) -> None:
    """Write a folder of pictures, unless it was written from the same sources and the same text."""
    stamp, state = folder / ".digest", digest_sources(text)
    if stamp.is_file() and stamp.read_text() == state:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write(folder)
    stamp.write_text(state)


def digest_sources(text: str) -> str:
    """SHA-256 of a text and of all files that decide the results of a command."""
    digest = hashlib.sha256(text.encode())
    for folder in SOURCES:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".py", ".toml", ".typ", ".html", ".css"):
                digest.update(path.read_bytes())
    return digest.hexdigest()


def draw_page(document: Path, page: int, target: Path) -> None:
    """Picture of a page of a PDF document, numbered from 1."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(document, Path(folder) / "document.pdf")
        source = (
            f'#set page(margin: 0pt, width: auto, height: auto)\n#image("document.pdf", page: {page}, width: 210mm)'
        )
        (Path(folder) / "page.typ").write_text(source)
        typst.compile(Path(folder) / "page.typ", output=target, format="png", ppi=RESOLUTION_PPI)
