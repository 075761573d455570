"""Tutorials: each runs when the site is built, and its results become its pictures."""

import re
import shutil
import tempfile
from pathlib import Path

from site_pages.page_blocks import list_pictures, read_blocks
from site_pages.page_run import PageRun, start_page_run
from site_pages.picture_folder import draw_page
from site_pages.unrun_blocks import find_reason

PDF_PAGE = re.compile(r"(?P<file>.+\.pdf)-(?P<page>\d+)\.png")
"""Name of a picture that is a page of a PDF document: `certificate.pdf-1.png`."""


WHOLE_CLONE = ("contributor",)
"""Tutorials that change the code or the library."""


def run_tutorial(page: Path, folder: Path) -> PageRun:
    """Run every block of a page in a folder; raises `BlockFault`."""
    run = start_page_run(folder, whole=page.stem in WHOLE_CLONE)
    for block in read_blocks(page):
        if find_reason(block) is None:
            run.take(block)
    return run


def write_tutorial_pictures(page: Path, target: Path) -> None:
    """Run a tutorial, and write the pictures that it shows."""
    with tempfile.TemporaryDirectory() as folder:
        run = run_tutorial(page, Path(folder) / "clone")
        for name in list_pictures(page):
            place_picture(run.current, name.removeprefix(f"{page.stem}/"), target)


def place_picture(folder: Path, name: str, target: Path) -> None:
    """Copy a picture from the folder of a run, or draw the page of the document that its name states."""
    (target / name).parent.mkdir(parents=True, exist_ok=True)
    if found := PDF_PAGE.fullmatch(name):
        draw_page(folder / found["file"], int(found["page"]), target / name)
    else:
        shutil.copy(folder / name, target / name)
