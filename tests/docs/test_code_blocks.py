"""Code blocks of README, CONTRIBUTING and docs: each runs as a part of its page, or a list states the reason."""

import shutil
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [*sorted(ROOT.glob("*.md")), *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("tutorials/*.md"))]
HOW_TO = (
    "compare", "identity", "line-update", "look", "pantograph-response", "pytest", "python",
    "site", "systems", "verification", "verify",
)  # fmt: skip
"""Pages whose blocks run in their order."""


@pytest.fixture
def page_run(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Module of the site that runs pages."""
    monkeypatch.syspath_prepend(str(DOCS))
    monkeypatch.setenv("MPLBACKEND", "agg")
    return import_module("site_pages.page_run")


@pytest.fixture
def unrun_blocks(page_run: ModuleType) -> ModuleType:
    """Module of the site with the list of the blocks that are not run."""
    return import_module("site_pages.unrun_blocks")


def read_blocks(page: Path) -> list[Any]:
    return import_module("site_pages.page_blocks").read_blocks(page)


def test_every_block_runs_or_has_a_reason(unrun_blocks: ModuleType) -> None:
    run_pages = {*(DOCS / f"{name}.md" for name in HOW_TO), *DOCS.glob("tutorials/*.md")}
    left = [
        f"{unrun_blocks.name_page(page)}: {block.text.splitlines()[0]}"
        for page in PAGES
        for block in read_blocks(page)
        if block.runs and page not in run_pages and unrun_blocks.find_reason(block) is None
    ]
    assert left == []


def test_every_entry_of_the_list_names_a_block(unrun_blocks: ModuleType) -> None:
    blocks = [block for page in PAGES for block in read_blocks(page) if block.runs]
    for entry in unrun_blocks.read_list()["block"]:
        named = [
            block
            for block in blocks
            if unrun_blocks.name_page(block.page) == entry["page"] and block.text.startswith(entry["begins"])
        ]
        assert len(named) == 1, entry
        assert len(entry["reason"].split()) > 1
    for page, test in unrun_blocks.read_list()["tested_elsewhere"].items():
        assert (DOCS / page).name in (ROOT / test).read_text(encoding="utf-8")


def test_commands_of_pages_are_in_blocks() -> None:
    """A command in an indented paragraph, or in a block without a language, would escape the tests."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        plain = [block.text for block in read_blocks(page) if block.language == ""]
        lines = [line.strip() for line in text.splitlines() if line.startswith("    ")]
        indented = [line for line in lines if line.startswith(("pantocheck ", "python ", "pytest ", ".ci/"))]
        blocks = "\n".join(block.text for block in read_blocks(page))
        assert [line for line in indented if line not in blocks] == [], page
        assert [part for part in plain if part.startswith(("pantocheck ", "python ", "pytest "))] == [], page


def run_pantocheck(run: Any, *commands: str) -> None:
    """Run commands in the folder of a page, before its first block."""
    block = import_module("site_pages.page_blocks").Block(DOCS / "index.md", 1, "sh", "\n".join(commands))
    run.take(block)


def prepare_comparison(run: Any) -> None:
    """Two records, a simulator, and the results of two versions."""
    for name in ("simulator.py", "pantocheck_adapter.py"):
        shutil.copy(run.root / "examples" / "string_catenary" / name, run.root)
    shutil.copy(run.root / "examples" / "string_catenary" / "adapter.py", run.root / "my_code.py")
    run_pantocheck(
        run,
        "pantocheck simulate en50318-2002/250 --out simulated.csv",
        "pantocheck simulate en50318-2002/250 --set pantograph.uplift_force_N=118 --out measured.csv",
        "pantocheck run en50318-2002/250 --formats json --out report-old",
        "cp -r report-old report-new",
    )


def prepare_responses(run: Any) -> None:
    """Measured responses at two static forces, a pantograph, and the limits of the page."""
    measured = run.root / "examples" / "dossier" / "measured"
    for source, force, target in (("response-70N", "70.0", "at-55N"), ("response-110N", "110.0", "at-70N")):
        shutil.copy(measured / f"{source}.csv", run.root / f"{target}.csv")
        sidecar = (measured / f"{source}.toml").read_text().replace(source, target).replace(force, f"{target[3:5]}.0")
        (run.root / f"{target}.toml").write_text(sidecar)
    shutil.copy(run.root / "examples" / "dossier" / "pantograph.toml", run.root / "my-pantograph.toml")
    blocks = read_blocks(DOCS / "pantograph-response.md")
    (limits,) = (block.text for block in blocks if block.language == "toml" and "[[limit]]" in block.text)
    one_height = "".join(line for line in limits.splitlines(keepends=True) if not line.startswith("heights_m"))
    (run.root / "limits.toml").write_text(one_height)


def prepare_adapter(run: Any) -> None:
    """An adapter that passes: the reference simulator in a process of its own."""
    program = run.root / "examples" / "external_program" / "adapter.py"
    lines = (
        "import runpy, sys",
        "sys.argv = ['adapter.py', 'pantocheck']",
        f"runpy.run_path({str(program)!r}, run_name='__main__')",
    )
    (run.root / "adapter.py").write_text("\n".join(lines))


def prepare_records(folder: str) -> Callable:
    """Records of the cases of EN 50318:2002 in a folder."""

    def prepare(run: Any) -> None:
        run_pantocheck(
            run, *(f"pantocheck simulate en50318-2002/{speed} --out {folder}/{speed}.csv" for speed in (250, 300))
        )

    return prepare


def prepare_certificate(run: Any) -> None:
    """A certificate of the reference simulator, and the record of the same run."""
    run_pantocheck(
        run,
        "pantocheck run en50318-2002/250 --out report",
        "pantocheck simulate en50318-2002/250 --out run.csv",
    )


PREPARATIONS: dict[str, Callable] = {
    "compare": prepare_comparison, "pantograph-response": prepare_responses, "pytest": prepare_adapter,
    "site": prepare_records("records"), "systems": prepare_records("my-records"), "verify": prepare_certificate,
}  # fmt: skip
"""Files that a page takes as given."""


@pytest.mark.thorough
@pytest.mark.parametrize("name", HOW_TO)
def test_page_runs_as_written(page_run: ModuleType, unrun_blocks: ModuleType, name: str, tmp_path: Path) -> None:
    if sys.platform == "win32":
        pytest.skip("the blocks of the pages are for bash")
    run = page_run.start_page_run(tmp_path / "clone", whole=False)
    PREPARATIONS.get(name, lambda _: None)(run)
    chosen = [block for block in read_blocks(DOCS / f"{name}.md") if unrun_blocks.find_reason(block) is None]
    faults = []
    for block in chosen:
        try:
            run.take(block)
        except page_run.BlockFault as fault:
            faults.append(str(fault))
    assert faults == []
    assert any(block.runs for block in chosen)
