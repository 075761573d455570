"""Scripts of the pages: the released library, own parts that are all used, and files that the wheel contains."""

import hashlib
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from pantocheck.conformance.drops.identification_plan import read_identification_plan
from pantocheck.conformance.pages.document import Document, PlainHeader
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.page_code import (
    CHOICE_SCRIPTS,
    CURVE_SCRIPTS,
    EXPLORE_SCRIPTS,
    SCENE_SCRIPTS,
    TABLE_SCRIPTS,
    read_explorer_code,
    read_plain_code,
    read_results_code,
)

TEMPLATES = Path(__file__).parents[3] / "templates"
LIBRARY = TEMPLATES / "uplot"


def test_library_for_plots_is_the_released_one_with_its_licence(page_text: str) -> None:
    release = tomllib.loads((LIBRARY / "release.toml").read_text("utf-8"))
    digests = {name: hashlib.sha256((LIBRARY / name).read_bytes()).hexdigest() for name in release["sha256"]}
    assert digests == release["sha256"]
    assert {path.name for path in LIBRARY.iterdir()} == {*digests, "release.toml"}
    script = (LIBRARY / "uPlot.iife.min.js").read_text("utf-8")
    assert script.startswith(f"/*! https://github.com/leeoniya/uPlot (v{release['version']}) */")
    assert script in read_results_code().scripts
    # The licence has to stand in every copy, and every page is a copy; a comment must not end inside of it.
    licence = (LIBRARY / "LICENSE").read_text("utf-8")
    assert "--" not in licence
    assert page_text.count(f"<!-- uPlot: {licence}-->") == 1
    assert "Leon Sorokin" not in render_html(Document("Title", PlainHeader("Heading", "Headline"), ()))


def test_every_part_of_the_script_is_used_once_and_packed() -> None:
    pages = [(*TABLE_SCRIPTS, *CHOICE_SCRIPTS, *CURVE_SCRIPTS), ("elements", *EXPLORE_SCRIPTS)]
    assert all(len(set(parts)) == len(parts) for parts in pages)
    parts = {f"{name}.js" for page in pages for name in page}
    assert sorted(parts) == sorted(path.name for path in (TEMPLATES / "scripts").iterdir())
    project = tomllib.loads((TEMPLATES.parent / "pyproject.toml").read_text("utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["pantocheck.templates"]
    packed = {path for pattern in patterns for path in TEMPLATES.glob(pattern) if path.is_file()}
    files = {path for path in TEMPLATES.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert files <= packed


def test_script_cannot_end_its_element_and_makes_no_markup_from_text() -> None:
    for code in (read_plain_code(), read_plain_code(scripts=SCENE_SCRIPTS), read_results_code(), read_explorer_code()):
        assert not [text for text in (*code.scripts, *code.styles) if re.search("</(?:script|style)|<!--", text, re.I)]
    # Texts of results enter the page as text nodes; code is not made from text.
    own, explorer = (code.scripts[-1] for code in (read_results_code(), read_explorer_code()))
    markup = r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function|srcdoc"
    requests = r"\bfetch\(|XMLHttpRequest|WebSocket|EventSource|sendBeacon|\bimport\("
    assert not re.findall(markup, own + explorer)
    assert not re.findall(requests, own)
    assert re.findall(requests, explorer) == ["fetch("]  # to its own server, by the policy of the page
    assert "connect-src 'self'" in read_explorer_code().policy
    assert "connect-src" not in read_results_code().policy


@pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js")
def test_plan_of_accepted_modes_is_a_plan(tmp_path: Path) -> None:
    """The function that writes the plan, without the page around it."""
    script = (TEMPLATES / "scripts" / "pole_choice.js").read_text("utf-8").partition("for (const table")[0]
    choices = (
        "[{ frequency: 0.873, ratio: 0.00201, accepted: true }, { frequency: 1.6, ratio: 0.002, accepted: false }]"
    )
    command = ["node", "-e", f"{script}; process.stdout.write(planText({choices}));"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    (tmp_path / "plan.toml").write_text(text, encoding="utf-8")
    poles = read_identification_plan(tmp_path / "plan.toml").pole
    assert [(pole.frequency_Hz, pole.damping_ratio, pole.action) for pole in poles] == [
        (0.873, 0.00201, "keep"),
        (1.6, 0.002, "drop"),
    ]


def test_scripts_of_a_page_define_the_functions_that_they_call() -> None:
    """A function that moves to another part is missing where only its callers are.

    A page with scenes alone has no curves, whose views it names.
    """
    defined = re.compile(r"^(?:async )?(?:function|class) (\w+)", re.M)
    texts = [path.read_text("utf-8") for path in (TEMPLATES / "scripts").iterdir()]
    names = {name for text in texts for name in defined.findall(text)}
    for code in (read_plain_code(), read_results_code(), read_explorer_code()):
        own = code.scripts[-1]
        called = {name for name in names if re.search(rf"(?<![.\w]){name}\(", own)}
        assert called <= set(defined.findall(own))
