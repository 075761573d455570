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
    ("model", "conformance"): 89_560,
    ("templates",): 4_680,
    ("verification",): 20_300,
    ("tests",): 59_750,
}
"""Largest number of lines by folders. The aim is 56,000 for the product and 42,000 for the tests.

The core of the time steps in C (1,780 lines of the product with its choice), pantographs as FMUs (1,650), records of
several files with clocks of their own (1,460) and heads in the checks of records (490) raised them before. Runs of
measured lines (1,710 lines of the product), a line as an FMU (810), the moving picture of a passage (620, and 660 of
templates) and the step with full matrices as a kernel (460, which left the tests) have raised them last.
A lower number replaces these whenever it is reached. A subject that must add lines raises its number in the same
commit, states the reason there, and adds at most 1,800 lines to the product, 1,500 to the tests and 900 to
`verification/`.
"""

MOST_WORDS = 79_900
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
