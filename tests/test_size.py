"""Size of the project: numbers that only fall.

Lines are counted in every language that a maintainer edits by hand: Python, C, JavaScript, C++, Octave and the
templates of pages. Data (TOML, JSON, CSV), translated texts and unmodified files of other packages do not count.
"""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CODE = {".py", ".c", ".h", ".js", ".css", ".html", ".typ", ".hpp", ".cpp", ".m"}
FOREIGN = {"uplot", "pkijs"}

LARGEST = {
    ("model", "conformance"): 96_480,
    ("templates",): 5_342,
    ("verification",): 20_340,
    ("tests",): 64_360,
}
"""Largest number of lines by folders. The aim is 56,000 for the product and 42,000 for the tests.

The core of the time steps in C (1,780 lines of the product with its choice), pantographs as FMUs (1,650), runs of
measured lines (1,710), records of several files with clocks of their own (1,460), a line as an FMU (810) and the moving
picture of a passage (620, and 660 of templates) raised them before. A line against a rig (960 lines of the product),
moving mass drops (450), the comparison of spans (320) and transients of mass drops (100) raised them next. The
explorer (1,110 lines of the product, 440 of templates), tables as sheets (940), bands, compared passages and files of
figures (840, and 250 of templates), figures without a plotting package (830), a map and a second clock of measured
lines (500), outputs of FMUs (140), clocks of mass drops (80) and checks of uplift (260) followed. Passages in lanes
(830 lines of the product, 350 of the tests), the rest of an uplift (110, and 180 of the tests), the scatter of a line
model (60), the start of commands (60), tests that kill mutants (360 of the tests), poles that do not depend on
rounding (50, and 60 of the tests), products of the columns of channels (150, and 70 of the tests) and filters
without scipy.signal (20, and 75 of the tests) have raised them last.
A lower number replaces these whenever it is reached. A subject that must add lines raises its number in the same
commit, states the reason there, and adds at most 1,800 lines to the product, 1,500 to the tests and 900 to
`verification/`.
"""

MOST_WORDS = 70_000
"""Largest number of words in the pages of `docs/`."""


def list_files(*folders: str) -> list[Path]:
    """Files of the repository, also those that are not committed yet."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "--", *folders],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [path for name in listed.stdout.splitlines() if (path := ROOT / name).is_file()]


@pytest.mark.parametrize("folders", LARGEST)
def test_lines_of_code_do_not_grow(folders: tuple[str, ...]) -> None:
    files = [path for path in list_files(*folders) if path.suffix in CODE and not FOREIGN & set(path.parts)]
    assert files
    assert sum(path.read_text(encoding="utf-8").count("\n") for path in files) <= LARGEST[folders]


def test_words_of_the_documentation_do_not_grow() -> None:
    pages = [path for path in list_files("docs") if path.suffix == ".md"]
    assert pages
    assert sum(len(path.read_text(encoding="utf-8").split()) for path in pages) <= MOST_WORDS
