"""Pages of the documentation site that are generated from the code, and the contents of the site."""

import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import pantocheck.conformance
import pantocheck.model
from pantocheck.conformance.app.commands.command_list import COMMANDS, load_command
from pantocheck.conformance.app.schemas import FORMAT_NAMES, build_schema
from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading import case_evaluation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities import filters
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.runs import record_checks

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def pages() -> Iterator[dict[str, str]]:
    """Text of every generated page by its name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        package: ModuleType = import_module("site_pages")
        yield {name: build() for name, build in package.PAGES.items()}


def test_every_option_key_quantity_and_public_name_is_described(pages: dict[str, str]) -> None:
    missing = []
    for name in COMMANDS:
        section = pages["commands"].split(f"## pantocheck {name}\n")[1].split("\n## ")[0]
        options = {option for parameter in load_command(name).params for option in parameter.opts if option[:2] == "--"}
        missing += [(name, option) for option in options - {"--help"} if option not in section]
    assert missing == []
    missing = []
    for name in FORMAT_NAMES:
        section = pages["formats"].split(f"## {name}\n")[1].split("\n## ")[0]
        schema = build_schema(name)
        parts = [schema, *schema.get("$defs", {}).values()]
        missing += [(name, key) for part in parts for key in part.get("properties", {}) if f"`{key}`" not in section]
    assert missing == []
    assert {name for name in QUANTITIES if f"`{name}`" not in pages["quantity-reference"]} == set()
    public = {*pantocheck.conformance.__all__, *pantocheck.model.__all__}
    assert {name for name in public if name not in pages["interface"]} == set()


def test_every_threshold_has_its_value_and_a_reason(pages: dict[str, str]) -> None:
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \|$", pages["thresholds"], re.MULTILINE)
    assert len(rows) > 200
    assert [name for name, _, reason in rows if len(reason) < 10] == []
    values = {name: value for name, value, _ in rows}
    assert values["HIGHEST_SHARE_OF_RATE"] == f"{filters.HIGHEST_SHARE_OF_RATE:g}"
    assert values["STOP_BAND"] == ", ".join(f"{value:g}" for value in record_checks.STOP_BAND)
    assert values["HIGHEST_ORDER"] == f"{case_evaluation.HIGHEST_ORDER:g}"  # one of two numbers of a statement
    assert (
        "misfit of the motion: contradiction above 0.1;" in import_module("site_pages.check_table").build_check_table()
    )


def test_navigation_and_list_of_pages_are_complete(pages: dict[str, str]) -> None:
    """A new page belongs into a toctree of docs/index.md."""
    blocks = re.findall(r"```\{toctree\}\n(.*?)```", (DOCS / "index.md").read_text("utf-8"), re.DOTALL)
    listed = [line for block in blocks for line in block.splitlines() if line and not line.startswith(":")]
    written = {path.stem for path in DOCS.glob("*.md")} - {"index"}
    tutorials = {f"tutorials/{path.stem}" for path in (DOCS / "tutorials").glob("*.md")}
    generated = {f"generated/{name}" for name in pages} | {"gallery/index"}
    assert sorted(listed) == sorted(written | tutorials | generated)
    # Written pages only; generated ones are named in the navigation by their content.
    for page in {*DOCS.glob("*.md"), *DOCS.glob("tutorials/*.md")} - {DOCS / "index.md"}:
        link = f"](../{page.relative_to(DOCS).as_posix()}) | "
        assert pages["all-pages"].count(link) == 1, page
        purpose = pages["all-pages"].split(link)[1].split(" |\n")[0]
        assert 15 < len(purpose) < 180, purpose


@pytest.mark.thorough
def test_picture_of_the_readme_is_that_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The legend states the standard deviations with one decimal; `python docs/site_pages/start_pictures.py DIR`."""
    monkeypatch.syspath_prepend(str(DOCS))
    monkeypatch.setenv("MPLBACKEND", "agg")
    pictures = import_module("site_pages.start_pictures")
    pictures.draw_contact_force(tmp_path / "contact-force.svg")
    legends = [
        re.findall(r"standard deviation ([\d.]+) N", (folder / "contact-force.svg").read_text("utf-8"))
        for folder in (DOCS, tmp_path)
    ]
    assert len(legends[0]) == 2
    assert legends[0] == legends[1]


def test_tables_of_written_pages(pages: dict[str, str]) -> None:
    """Every included table has a builder; that of the trust names every case."""
    tables = {name: build() for name, build in import_module("site_pages").TABLES.items()}
    text = "\n".join(page.read_text("utf-8") for page in DOCS.glob("*.md"))
    assert sorted(re.findall(r"^```\{include\} generated/tables/(.+)\.md$", text, re.MULTILINE)) == sorted(tables)
    (case,) = select_cases(["en50318-2002/250"])
    (row,) = (line for line in tables["limit-trust"].splitlines() if line.startswith(f"| `{case.id}` |"))
    assert f"{sum(limit.trust == 'secondary' for limit in case.limits)} secondary" in row
    assert all(f"| `{name}` |" in tables["limit-trust"] for name in list_library(library_folder()))
    assert "## en50318-2002/250" in pages["converged-values"]
