"""Pages in a browser: silent, without requests, as wide as the screen, accessible, complete without script."""

import hashlib
import lzma
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from helpers.example_results import example

pytestmark = pytest.mark.thorough

AXE = Path(__file__).parents[1] / "data" / "axe-core"

AXE_SCRIPT = lzma.decompress((AXE / "axe.min.js.xz").read_bytes())

NAMES = ["certificate", "measured", "passage", "compared", "hostile", "identification", "plain"]

OVERLAPS = """family => [...document.querySelectorAll("figure > div > svg")].flatMap(svg => {
  const texts = [...svg.querySelectorAll("text")];
  for (const text of texts) if (family) text.style.fontFamily = family;
  const boxes = texts.map(text => [text.textContent, text.getBoundingClientRect()]);
  return boxes.flatMap(([first, a], i) => boxes.slice(i + 1).flatMap(([second, b]) => {
    const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    return wide > 1 && high > 0.25 * Math.min(a.height, b.height) ? [[first, second]] : [];
  }));
})"""
"""Pairs of texts of a figure that overlap by more than a pixel; line boxes of two lines may touch."""


def find_violations(page: Any) -> list[str]:
    """Rules of axe-core that a page breaks, with the first element of each."""
    page.evaluate(AXE_SCRIPT.decode())
    broken = page.evaluate("axe.run(document, {resultTypes: ['violations']}).then(found => found.violations)")
    return [f"{rule['id']} ({rule['impact']}): {rule['nodes'][0]['html']}" for rule in broken]


def test_axe_core_is_the_released_file() -> None:
    digest = hashlib.sha256(AXE_SCRIPT).hexdigest()
    assert f"`{digest}`" in (AXE / "README.md").read_text("utf-8")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("width", [1280, 390])
def test_page_is_as_wide_as_the_screen(open_page: Any, name: str, width: int) -> None:
    page = open_page(name, width)
    page.evaluate("for (const section of document.querySelectorAll('details')) section.open = true")
    assert page.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize(
    ("name", "scheme"),
    [
        *(("certificate", "dark"), ("hostile", "light"), ("identification", "dark"), ("plain", "light")),
        *(("plain", "dark"), ("passage", "light"), ("passage", "dark"), ("compared", "dark")),
    ],
)
def test_page_breaks_no_rule_of_accessibility(open_page: Any, name: str, scheme: str) -> None:
    """Among the rules are the contrast of texts, names of controls, the order of headings, and use by keyboard."""
    page = open_page(name, color_scheme=scheme)
    page.evaluate("for (const section of document.querySelectorAll('details')) section.open = true")
    for figure in page.locator("figure[data-curves]").all():
        figure.scroll_into_view_if_needed()
        figure.locator("canvas").first.wait_for()
    assert find_violations(page) == []


@pytest.mark.parametrize("name", ["certificate", "passage"])
def test_phone_page_breaks_no_rule_of_accessibility(open_page: Any, name: str) -> None:
    assert find_violations(open_page(name, 390)) == []


def test_dark_page_is_dark_with_its_figures(open_page: Any) -> None:
    """The figures are drawn on white; their filter turns white into the dark paper of the page."""
    page = open_page("certificate", color_scheme="dark")
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert paper == "rgb(26, 26, 26)"
    figure = page.locator("figure.half svg").first
    assert "invert(0.9)" in figure.evaluate("svg => getComputedStyle(svg).filter")
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"


@pytest.mark.parametrize("name", ["certificate", "identification"])
@pytest.mark.parametrize("family", ["", "Verdana, sans-serif", "sans-serif"])
def test_texts_of_figures_do_not_overlap(open_page: Any, name: str, family: str) -> None:
    """The figures are laid out for DejaVu Sans; the other fonts of the style sheet are not wider."""
    page = open_page(name, java_script_enabled=False)
    assert page.evaluate(OVERLAPS, family) == []


def test_text_of_a_figure_can_be_searched(open_page: Any) -> None:
    page = open_page("certificate", java_script_enabled=False)
    assert page.evaluate("window.find('position along the track')")


def test_page_without_script_shows_every_figure_and_no_tools(open_page: Any) -> None:
    page = open_page("certificate", java_script_enabled=False)
    assert page.locator(".tools").count() == 0
    figures = page.locator("figure > div > svg")
    shown = example()["cases"]
    first_page = page.locator(".answers figure > div > svg").count()
    assert first_page > 0
    assert figures.count() - first_page == sum(
        3 * len(case["traces"]) + bool(case["traces"]) + bool(case["uplift"]) for case in shown
    )
    assert all(figure.is_visible() for figure in figures.all())
    summary = page.locator("summary", has_text="All quantities").first
    summary.click()
    assert page.get_by_text("wave_speed_m_s").first.is_visible()


def test_link_into_a_folded_section_opens_it(open_page: Any) -> None:
    page = open_page("certificate")
    folded = page.locator("details:not([open])")
    count = folded.count()
    page.evaluate("document.querySelector('details td, details th').id = 'inside'; location.hash = '#inside'")
    page.wait_for_function(f"document.querySelectorAll('details:not([open])').length === {count - 1}")
    assert page.locator("#inside").is_visible()


def test_policy_refuses_what_was_added_to_a_page(browser: Any, page_files: dict[str, Path], tmp_path: Path) -> None:
    """A script, a style and an image that reach a page without its digests have no effect."""
    added = """<script>document.title = "changed"</script><p style="color: red" id="added">text</p>
        <img src="http://127.0.0.1:9/a.png" onerror="document.title = 'changed'">"""
    text = page_files["plain"].read_text("utf-8").replace("</main>", f"{added}</main>")
    (tmp_path / "changed.html").write_text(text, "utf-8")
    page, refused = browser.new_page(), []
    page.on("console", lambda message: refused.append(message.text))
    page.goto((tmp_path / "changed.html").as_uri())
    assert page.title() == "Identification"
    assert page.locator("#added").evaluate("part => getComputedStyle(part).color") != "rgb(255, 0, 0)"
    assert len([text for text in refused if "Content Security Policy" in text]) >= 3
    page.close()


def test_page_holds_no_address_of_another_place(page_files: dict[str, Path]) -> None:
    """Names of XML formats and the comment of the library are no requests; nothing else looks like an address."""
    known = {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink", "https://github.com/leeoniya/uPlot"}
    for file in page_files.values():
        assert set(re.findall(r"https?://[^\s\"'<>)]+", file.read_text("utf-8"))) <= known


@pytest.mark.parametrize("name", ["identification", "certificate"])
def test_figures_are_saved_as_drawings_and_as_data(open_page: Any, name: str) -> None:
    """The saved drawing is whole by itself; pages without results have the data of each figure."""
    page = open_page(name, accept_downloads=True)
    page.evaluate("for (const section of document.querySelectorAll('details')) section.open = true")
    saved = {}
    for label in ("Figure as SVG", "Data as CSV"):
        links = page.get_by_role("button", name=label)
        if links.count():
            with page.expect_download() as download:
                links.first.click()
            saved[label] = Path(download.value.path()).read_text("utf-8")
    root = ElementTree.fromstring(saved["Figure as SVG"])
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "data-points" not in root.attrib
    assert ("Data as CSV" in saved) == (name == "identification")
    if name == "identification":
        assert saved["Data as CSV"].startswith("panel,curve,x,y\n")
