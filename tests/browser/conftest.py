"""A real browser for the pages: headless Chromium of the distribution, driven by Playwright.

Without a browser the tests are skipped with the reason.
"""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from operator import itemgetter
from pathlib import Path
from typing import Any

import pytest

from helpers.example_identification import build_example_line
from helpers.example_network import build_network
from helpers.example_passage import STEP_S, with_passage
from helpers.example_results import chart, example, with_hostile_text, with_measured_run, with_reference
from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.run_comparison import add_scenes, compare_subjects
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.document import Document, Figure, Figures, PlainHeader, Section, make_grid
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.identification_page import build_identification_document
from pantocheck.conformance.pages.network_page import build_network_page
from pantocheck.conformance.pages.run_comparison_page import build_run_comparison
from pantocheck.conformance.pages.site_pages import build_site_index, order_results
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.results.identification_format import IdentifiedLine
from pantocheck.conformance.results.motion_format import code_field
from pantocheck.conformance.results.results_format import Results, SystemIdentity

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""Programs that Playwright can drive without a browser of its own."""

SWITCHES = (
    *("--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
)

WIDE = 1280
"""Width of a desktop [px]."""


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """One browser for all tests of a process."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="the package playwright is not installed")
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    with sync_api.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=program, args=list(SWITCHES))
        yield started
        started.close()


def build_plain_document() -> Document:
    """A page without results: a chart and a table long enough for sorting."""
    numbers = [{"f": f"{value:g}", "note": f"mode {value:g}"} for value in (3.5, -1.0, 20.0, *range(30, 40))]
    table = make_grid("Modes", numbers, {"f [Hz]": itemgetter("f"), "Note": itemgetter("note")})
    data = Chart.model_validate(chart("measured", "Damping ratios"))
    figure = Figure(draw_chart(data), data.alternative, data.caption)
    blocks = (Section("Modes", (Figures((figure,)), table)),)
    return Document("Identification", PlainHeader("Identification", "13 modes"), blocks)


def build_site_page() -> Document:
    """First page of a site: two systems on twelve cases; the second system passes every third of them."""
    contents = []
    for system, verdicts in (("first", ["pass"] * 12), ("second", ["pass", "fail", "skip"] * 4)):
        results = Results.model_validate(example())
        cases = [
            results.cases[0].model_copy(update={"id": f"case/{i}", "verdict": verdict, "library": "own"})
            for i, verdict in enumerate(verdicts, 1)
        ]
        identity = SystemIdentity(name=system, version="1", kind="record")
        contents.append((results.model_copy(update={"system": identity, "cases": cases}), ()))
    pages = {f"case/{i}": f"cases/{i}.html" for i in range(1, 13)}
    return build_site_index("Site", order_results(contents), pages)


def build_compared_page() -> Document:
    """Comparison of the example passage with one of half the rise, which starts one frame later."""
    subjects = []
    for name, share in (("first", 1.0), ("second", 0.5)):
        case = Results.model_validate(with_passage()).cases[0]
        assert case.motion is not None
        wires = [
            wire.model_copy(update={"rise_mm": code_field(share * wire.rise_mm.decode(), 0.1)})
            for wire in case.motion.wires
        ]
        motion = case.motion.model_copy(update={"wires": wires, "start_s": case.motion.start_s + (share < 1) * STEP_S})
        run = ComparedRun("results", name, "", "", case.id, None, {}, {}, shape=case.line_shape, motion=motion)
        subjects.append([run])
    return build_run_comparison(add_scenes(compare_subjects(subjects, None), subjects))


@pytest.fixture(scope="session")
def page_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Pages by name: certificates, one of them with hostile texts, a mass-drop report, measured lines of
    5,000 km, and a page without results."""
    documents = {
        "certificate": build_certificate(Results.model_validate(example())),
        "measured": build_certificate(Results.model_validate(with_measured_run())),
        "passage": build_certificate(Results.model_validate(with_passage())),
        "compared": build_compared_page(),
        "reference": build_certificate(Results.model_validate(with_reference())),
        "hostile": build_certificate(Results.model_validate(with_hostile_text())),
        "identification": build_identification_document([IdentifiedLine.model_validate(build_example_line())]),
        "network": build_network_page(build_network()),
        "plain": build_plain_document(),
        "site": build_site_page(),
    }
    folder = tmp_path_factory.mktemp("pages")
    for name, document in documents.items():
        (folder / f"{name}.html").write_text(render_html(document), "utf-8")
    return {name: folder / f"{name}.html" for name in documents}


@dataclass
class Watch:
    """Messages and requests of a page besides its own file."""

    complaints: list[str] = field(default_factory=list)

    def observe(self, page: Any, address: str) -> None:
        """Note console messages, errors and requests of a page."""
        page.on("console", lambda message: self.complaints.append(f"console: {message.text}"))
        page.on("pageerror", lambda error: self.complaints.append(f"error: {error}"))
        page.on(
            "request",
            lambda request: None if request.url == address else self.complaints.append(f"request: {request.url}"),
        )


Opener = Callable[..., Any]


@pytest.fixture
def open_page(browser: Any, page_files: dict[str, Path]) -> Iterator[Opener]:
    """Function that opens a page by name; a message, an error or a request of a page fails the test.

    Its options are those of a context of Playwright, such as `color_scheme` or `java_script_enabled`.
    """
    watch, contexts = Watch(), []

    def open_named(name: str, width: int = WIDE, timeout_ms: int = 5000, **options: Any) -> Any:
        context = browser.new_context(viewport={"width": width, "height": 900}, **options)
        contexts.append(context)
        context.set_default_timeout(timeout_ms)
        page = context.new_page()
        address = page_files[name].as_uri()
        watch.observe(page, address)
        page.goto(address)
        return page

    yield open_named
    for context in contexts:
        context.close()
    assert watch.complaints == []
