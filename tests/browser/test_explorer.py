"""The explorer in a browser: sliders redraw, values are those of the simulator, two settings, keys, and refusals."""

import json
import re
import shlex
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands.explore_command import open_explorer
from pantocheck.conformance.app.explorer.explore_server import ExploreServer
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

pytestmark = pytest.mark.thorough

CASE = "en50318-2002/250"

RECORD_AXES = """() => {
  window.axes = new Map();
  const write = CanvasRenderingContext2D.prototype.fillText;
  CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
    const { canvas, textAlign } = this;
    if (textAlign === "right" && !canvas.isConnected) axes.set(canvas, [...(axes.get(canvas) ?? []), text]);
    return write.call(this, text, ...place);
  };
}"""
"""Script that records the numbers at the axes of the signals, which are drawn on a layer of each picture."""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ExploreServer]:
    running = ExploreServer(*open_explorer(CASE, (), (), tmp_path / "saved"))
    threading.Thread(target=running.serve_forever, daemon=True).start()
    yield running
    running.shutdown()
    running.server_close()


@pytest.fixture
def page(browser: Any, server: ExploreServer) -> Iterator[Any]:
    """The explorer after its first passage; a message, an error or a request to another server fails the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    opened, complaints = context.new_page(), list[str]()
    opened.on("pageerror", lambda error: complaints.append(str(error)))
    opened.on("console", lambda message: complaints.append(message.text))
    origin = server.address.partition("?")[0]
    opened.on("request", lambda request: request.url.startswith(origin) or complaints.append(request.url))
    act(opened, lambda: opened.goto(server.address))
    yield opened
    context.close()
    # A refused value is an answer with the status 400, which the browser writes to its console.
    assert [text for text in complaints if "status of 400" not in text] == []


def wait(page: Any) -> None:
    page.locator("body:not([aria-busy])").wait_for(timeout=60_000)


def act(page: Any, action: Callable[[], object]) -> None:
    """Do something that asks for a passage, and wait for it; the page is busy before it asks."""
    with page.expect_response("**/simulate"):
        action()
    wait(page)


def change(page: Any, label: str, value: float) -> None:
    """Type a number beside a slider."""
    act(page, lambda: page.get_by_role("spinbutton", name=label, exact=True).fill(str(value)))


def read_values(page: Any, column: int) -> dict[str, str]:
    """Numbers of a column of the table of values, with all their digits, by the quantity of the row."""
    rows = page.locator("section:has(#values) tbody tr")
    return {
        row.locator("th").get_attribute("title"): row.locator("data").nth(column).get_attribute("value")
        for row in rows.all()
    }


def repeat(page: Any, folder: Path) -> dict[str, float]:
    """Values of the command that the page shows."""
    _, *arguments = shlex.split(page.locator("section:has(#inputs) code").inner_text())
    assert pantocheck(*arguments, "--formats", "json", "--out", folder).exit_code == 3  # a changed case has no limits
    quantities = json.loads((folder / "results.json").read_text())["cases"][0]["quantities"]
    return {name: value for owner in quantities.values() for name, value in owner.items() if isinstance(value, float)}


def simulate(*texts: str) -> dict[str, float]:
    case = load_case(list_library(library_folder())[CASE], parse_changes(texts))
    values = CaseEvaluation(case, ReferenceSimulator().run_unrefined(case)).evaluation.values
    return {name: value for owner in values for name, value in values[owner].items() if isinstance(value, float)}


def test_speed_slider_redraws_and_shows_the_values_of_the_simulator(page: Any, tmp_path: Path) -> None:
    """The numbers of the page have every bit of those of the simulator, and of the command that it shows."""
    before = page.locator("section:has(#picture) canvas").screenshot()
    curve = page.locator("section:has(#force) canvas").first.screenshot()
    assert {name: float(text) for name, text in read_values(page, 0).items()}.items() <= simulate().items()
    change(page, "speed [km/h], exact", 290)
    expected = simulate("speed_km_h=290")
    shown = {name: float(text) for name, text in read_values(page, 0).items()}
    assert len(shown) > 10
    assert shown.items() <= expected.items()
    assert shown.items() <= repeat(page, tmp_path / "out").items()
    assert page.locator("section:has(#picture) canvas").screenshot() != before
    assert page.locator("section:has(#force) canvas").first.screenshot() != curve
    assert "--set speed_km_h=290.0" in page.locator("section:has(#inputs)").inner_text()
    assert page.locator(".outside").count() > 0
    values = page.locator("section:has(#values)").inner_text()
    assert "Standard deviation" in values
    assert "std_force_N" not in values
    assert "certificate" in page.locator(".warnings").inner_text()
    assert page.locator(".verdict").count() == 0


def test_slider_follows_the_keys_and_the_case(page: Any) -> None:
    slider = page.get_by_role("slider", name="speed [km/h]", exact=True)
    act(page, lambda: slider.press("ArrowRight"))
    assert slider.get_attribute("aria-valuetext") == "251 km/h"
    assert page.get_by_role("spinbutton", name="speed [km/h], exact").input_value() == "251"
    stiffness = page.get_by_role("slider", name="contact stiffness [N/m]", exact=True)
    act(page, lambda: stiffness.press("End"))
    assert stiffness.get_attribute("aria-valuetext") == "500000 N/m"
    act(page, page.get_by_role("button", name="Values of the case").click)
    assert slider.get_attribute("aria-valuetext") == "250 km/h"
    assert "--set" not in page.locator("section:has(#inputs) code").inner_text()


def test_two_settings_stand_side_by_side(page: Any) -> None:
    page.get_by_role("button", name="Keep as setting 2").click()
    change(page, "uplift force [N], exact", 140)
    assert page.locator(".outdated").count() == 0
    first, second = read_values(page, 0), read_values(page, 1)
    assert float(first["mean_force_N"]) == simulate("pantograph.uplift_force_N=140")["mean_force_N"]
    assert float(second["mean_force_N"]) == simulate()["mean_force_N"]
    boxes = [figure.bounding_box() for figure in page.locator("section:has(#picture) figure").all()]
    assert len(boxes) == 2
    assert boxes[0]["y"] == pytest.approx(boxes[1]["y"], abs=1)
    assert page.get_by_text("setting 2, 0–20 Hz").count() == 1
    headings = page.locator("section:has(#values) thead").inner_text()
    assert "uplift force 140 N" in headings
    assert "inputs of the case" in headings
    assert "Setting 1: uplift force 140 N" in page.locator("section:has(#inputs)").inner_text()
    page.evaluate(RECORD_AXES)
    page.set_viewport_size({"width": 1200, "height": 900})
    page.wait_for_timeout(300)
    ranges = page.evaluate("[...axes.values()].map(String)")
    page.get_by_role("button", name="Smallest force").nth(1).click()
    page.wait_for_timeout(200)
    times = [text.partition(";")[0] for text in page.locator("section:has(#picture) .readout").all_inner_texts()]
    assert len(ranges) == len(times) == 2
    assert ranges[0] == ranges[1]
    assert times[0] == times[1]
    page.get_by_role("button", name="Remove setting 2").click()
    assert page.locator("section:has(#picture) figure").count() == 1
    assert page.locator("section:has(#values) th", has_text="setting 2").count() == 0


def test_refused_value_keeps_the_last_passage(page: Any) -> None:
    """The message stands in the control of the field, and the values are marked until a number is accepted."""
    before = read_values(page, 0)
    field = page.get_by_role("spinbutton", name="speed [km/h], exact", exact=True)
    control = page.locator(".control").filter(has=field)
    for text, problem in (("999", "Outside of the range"), ("", "No number")):
        field.fill(text)
        control.get_by_text(f"{problem}. Choose 125 to 375 km/h.").wait_for()
        page.get_by_text("Outdated: the values are those of the last setting").wait_for()
        assert read_values(page, 0) == before
    change(page, "speed [km/h], exact", 260)
    assert page.locator(".outdated").count() == 0
    assert page.get_by_text("Outdated").count() == page.get_by_text("Outdated").filter(visible=False).count()


def test_bars_of_pantographs_have_one_scale(browser: Any, tmp_path: Path) -> None:
    """Widths of all bars are proportional to their numbers, which have three digits; a bar of 100 px has 1 px."""
    running = ExploreServer(*open_explorer("en50318-2018/ac-simple/275-twin", (), (), tmp_path))
    threading.Thread(target=running.serve_forever, daemon=True).start()
    page = browser.new_page()
    page.goto(running.address)
    page.locator(".bars").nth(1).wait_for(timeout=120_000)
    rows = page.locator(".band .row").all()
    numbers = [float(row.inner_text().split()[0]) for row in rows]
    widths = [row.locator(".bar").bounding_box()["width"] for row in rows]
    page.close()
    running.shutdown()
    running.server_close()
    assert len(rows) == 6
    scale = max(widths) / max(numbers)
    assert widths == pytest.approx([scale * number for number in numbers], rel=0.01, abs=1)


def test_setting_is_saved_as_case_and_campaign(page: Any, server: ExploreServer) -> None:
    change(page, "speed [km/h], exact", 280)
    page.get_by_role("button", name="Save as case").click()
    page.get_by_text(re.compile("^Written: .*case.toml")).wait_for()
    page.get_by_role("button", name="Save as campaign").click()
    page.get_by_text(re.compile("^Written: .*campaign.toml")).wait_for()
    page.get_by_role("button", name="Save as case").click()
    page.get_by_text(re.compile("exists already")).wait_for()
    assert [path.name for path in server.saved] == ["case.toml", "explored-campaign.toml"]
    assert load_case(server.saved[0]).file.speed_km_h == 280.0


@pytest.mark.parametrize("width", [390, 768, 1440])
def test_explorer_fits_the_width(page: Any, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    page.get_by_role("button", name="Keep as setting 2").click()
    page.wait_for_timeout(300)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_every_control_has_a_name(page: Any) -> None:
    for control in page.locator("input, select, button, [tabindex='0']").all():
        assert control.evaluate(
            "node => (node.ariaLabel ?? node.innerText ?? '') + [...(node.labels ?? [])].map(l => l.innerText)"
        )


def test_page_without_token_is_refused(browser: Any, server: ExploreServer) -> None:
    page = browser.new_page()
    answer = page.goto(server.address.partition("?")[0])
    assert answer.status == 403
    assert "Open the address again" in page.inner_text("body")
    page.close()
