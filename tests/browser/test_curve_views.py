"""Curves in a browser: zoom, pan, values, legend, spectrum, spans, places of extremes, files, keys and fingers."""

import csv
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.example_results import SPEED, example
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.quantities.bands import amplitude_spectrum

pytestmark = pytest.mark.thorough

FIGURE = "#case-1-force-1"
LEVELS = ("mean_force_N", "max_force_N", "min_force_N")
TRACE = example()["cases"][0]["traces"]["1"]
POSITION = np.array(TRACE["position_m"])


@pytest.fixture
def page(open_page: Any) -> Any:
    """The certificate with the first force in view."""
    page = open_page("certificate")
    page.locator(FIGURE).scroll_into_view_if_needed()
    page.locator(f"{FIGURE} canvas").first.wait_for()
    return page


def read_stretch(page: Any) -> tuple[float, float]:
    """Ends of the visible stretch, from the sentence above its spectrum [m]."""
    text = page.locator(f"{FIGURE} .pair p").first.inner_text()
    found = re.search(r"([\d.]+) m to ([\d.]+) m", text)
    assert found is not None
    return float(found[1]), float(found[2])


def plot_area(page: Any, number: int = 0, figure: str = FIGURE) -> Any:
    """Area of a plot of a figure: force, spectrum, spans."""
    return page.locator(f"{figure} .area").nth(number)


def read_status(page: Any, number: int = 0, figure: str = FIGURE) -> str:
    return str(page.locator(f"{figure} .plot [role=status]").nth(number).text_content()).replace("−", "-")


def read_numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+\.?\d*(?= (?:N|m|Hz|mm|s)\b)", text.replace("−", "-"))]


def drag(page: Any, start: float, end: float, key: str | None = None) -> None:
    """Drag the mouse between two shares of the width of the first plot."""
    box = page.locator(f"{FIGURE} .u-over").first.bounding_box()
    height = box["y"] + box["height"] / 2
    if key:
        page.keyboard.down(key)
    page.mouse.move(box["x"] + start * box["width"], height)
    page.mouse.down()
    page.mouse.move(box["x"] + end * box["width"], height, steps=5)
    page.mouse.up()
    if key:
        page.keyboard.up(key)


def test_dragging_zooms_and_with_shift_moves(page: Any) -> None:
    """The ends agree with the mouse within two pixels of about a thousand, 0.3 m of 120 m."""
    whole = read_stretch(page)
    assert_allclose(whole, (POSITION[0], POSITION[-1]), atol=1e-3)
    length = whole[1] - whole[0]
    drag(page, 0.25, 0.5)
    assert_allclose(read_stretch(page), (whole[0] + length / 4, whole[0] + length / 2), atol=0.3)
    drag(page, 0.8, 0.3, key="Shift")
    assert_allclose(read_stretch(page), (whole[0] + 0.375 * length, whole[0] + 0.625 * length), atol=0.3)
    page.locator(f"{FIGURE} .u-over").first.dblclick()
    assert_allclose(read_stretch(page), whole, atol=1e-3)


def test_buttons_zoom_move_and_stop_at_the_ends(page: Any) -> None:
    def press(name: str) -> None:
        page.locator(FIGURE).get_by_role("button", name=name, exact=True).click()

    start, end = read_stretch(page)
    length = end - start
    press("Zoom in")
    assert_allclose(read_stretch(page), (start + length / 4, end - length / 4), atol=1e-3)
    press("Move right")
    assert_allclose(read_stretch(page), (start + 3 / 8 * length, end - length / 8), atol=1e-3)
    for _ in range(4):
        press("Move right")
    assert_allclose(read_stretch(page), (start + length / 2, end), atol=1e-3)
    press("Zoom out")
    press("Zoom out")
    assert_allclose(read_stretch(page), (start, end), atol=1e-3)
    for _ in range(12):
        press("Zoom in")
    low, high = read_stretch(page)
    assert np.sum((low <= POSITION) & (high >= POSITION)) >= 8
    press("Show all")
    assert_allclose(read_stretch(page), (start, end), atol=1e-3)


def test_mouse_shows_the_values_of_the_curves(page: Any) -> None:
    """Values in the legend have four digits."""
    plot_area(page).hover(position={"x": 400, "y": 120})
    legend = page.locator(f"{FIGURE} .legend").first
    [place] = read_numbers(legend.locator(".place").inner_text())
    sample = int(np.argmin(np.abs(POSITION - place)))
    unfiltered, filtered, mean, *_ = (read_numbers(text)[-1] for text in legend.locator("label").all_inner_texts())
    assert_allclose(place, POSITION[sample], atol=1e-3)
    expected = (TRACE["force_N"][sample], TRACE["force_20_N"][sample], TRACE["mean_N"])
    assert_allclose((unfiltered, filtered, mean), expected, rtol=5e-4)


def test_limits_of_the_force_are_shown_and_named(page: Any) -> None:
    """Their names and values are read with the plot, and their ground changes its picture."""
    rows = [row for row in example()["cases"][0]["criteria"] if row["pantograph"] == 1 and row["lower"] is not None]
    [mean] = [row for row in rows if row["quantity"] == "mean_force_N"]
    label = str(plot_area(page).get_attribute("aria-label")).replace("−", "-")
    assert f"mean {mean['lower']:g}–{mean['upper']:g} N" in label
    ground = page.evaluate(
        """figure => {
          const canvas = document.querySelector(`${figure} canvas`);
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const isPale = (i) => data[i] === 243 && data[i + 1] === 245 && data[i + 2] === 247;
          const count = data.length / 4;
          return Array.from({ length: count }, (_, n) => isPale(4 * n)).filter(Boolean).length / count;
        }""",
        FIGURE,
    )
    shares = [row["upper"] - row["lower"] for row in rows if row["quantity"] in LEVELS]
    # The limits span a tenth of the axis from 30 to 230 N each at least, less what curves and names hide.
    assert 0.4 * sum(shares) / 200 < ground < sum(shares) / 200


def test_legend_switches_curves(page: Any) -> None:
    """A hidden curve is neither drawn nor read."""
    area = plot_area(page)
    before = area.screenshot()
    switch = page.locator(f"{FIGURE} .legend").first.get_by_label("unfiltered")
    switch.focus()
    page.keyboard.press("Space")
    assert area.screenshot() != before
    area.press("ArrowRight")
    assert "0–20 Hz" in read_status(page)
    assert "unfiltered" not in read_status(page)
    page.mouse.move(0, 0)
    switch.check()
    area.press("ArrowRight")
    assert "unfiltered" in read_status(page)


def test_keys_read_values_zoom_and_move(page: Any) -> None:
    area = plot_area(page)
    area.press("ArrowRight")
    first = read_numbers(read_status(page))
    area.press("ArrowRight")
    second = read_numbers(read_status(page))
    assert_allclose(second[0] - first[0], np.mean(np.diff(POSITION)), atol=2e-3)
    start, end = read_stretch(page)
    area.press("+")
    area.press("Shift+ArrowLeft")
    length = end - start
    assert_allclose(read_stretch(page), (start + length / 8, end - 3 / 8 * length), atol=1e-3)
    area.press("-")
    area.press("Home")
    assert_allclose(read_stretch(page), (start, end), atol=1e-3)


def test_every_control_is_reached_with_the_tab_key(page: Any) -> None:
    """In this order: buttons of the figure, curves of its legend, the plot itself."""
    page.locator(FIGURE).get_by_role("button", name="Zoom out", exact=True).focus()
    names = []
    for _ in range(13):
        page.keyboard.press("Tab")
        focus = "document.activeElement"
        names.append(page.evaluate(f"{focus}.type || {focus}.getAttribute('role')"))
    assert names[:6] == ["button"] * 6
    assert names[6:12] == [*["checkbox"] * 5, "application"]


def amplitude_at(force: Any, frequency: float) -> float:
    frequencies, amplitudes = amplitude_spectrum(np.array(force), SPEED / float(np.mean(np.diff(POSITION))), 50.0)
    return float(amplitudes[np.argmin(np.abs(frequencies - frequency))])


def test_spectrum_belongs_to_the_visible_stretch(page: Any) -> None:
    """Four digits are shown; the step between samples is that of rounded positions, to a part in a thousand."""
    for key in (None, "+"):
        if key:
            plot_area(page).press(key)
        start, end = read_stretch(page)
        visible = [force for x, force in zip(POSITION, TRACE["force_N"], strict=True) if start <= x <= end]
        spectrum = plot_area(page, 1)
        spectrum.press("Home")
        spectrum.press("ArrowRight")
        frequency, amplitude = read_numbers(read_status(page, 1))
        assert_allclose(amplitude, amplitude_at(visible, frequency), rtol=2e-3, atol=1e-3)
    for _ in range(8):
        plot_area(page).press("+")
    assert "too short for a spectrum" in page.locator(f"{FIGURE} .pair p").first.inner_text()


def test_amplitudes_are_those_of_the_suite(browser: Any) -> None:
    """The same definition: the rest is rounding."""
    page = browser.new_page()
    force = np.random.default_rng(1).normal(120, 20, 333)
    script = (TEMPLATES / "scripts" / "spectrum.js").read_text("utf-8")
    shown = page.evaluate(f"force => {{ {script}; return amplitudeSpectrum(force, 0.002); }}", list(force))
    frequency, amplitude = amplitude_spectrum(force, 500.0, 50.0)
    assert_allclose(shown["frequency"], frequency, rtol=1e-12)
    assert_allclose(shown["amplitude"], amplitude, rtol=1e-9)
    assert page.evaluate(f"{script}; evenStep([0, 1, 2, 3.1])") == pytest.approx(31 / 30)
    assert page.evaluate(f"{script}; evenStep([0, 1, 1.2, 3])") is None
    page.close()


def test_spans_are_laid_over_each_other(page: Any) -> None:
    """Both spans of the example begin at their own support; four digits, and a grid of a quarter of a metre."""
    labels = page.locator(f"{FIGURE} .legend").nth(2).locator("label").all_inner_texts()
    assert [label.strip().split(" m")[0] for label in labels] == ["240–300", "300–360"]
    area = plot_area(page, 2)
    area.press("ArrowRight")
    distance, first, second = (read_numbers(part)[-1] for part in read_status(page, 2).split(", "))
    for start, value in ((240, first), (300, second)):
        assert_allclose(value, np.interp(start + distance, POSITION, TRACE["force_20_N"]), rtol=1e-3)


@pytest.mark.parametrize(("quantity", "extreme"), [("max_force_N", max), ("min_force_N", min)])
def test_criterion_leads_to_the_place_of_its_extreme(
    page: Any, quantity: str, extreme: Callable[[list[float]], float]
) -> None:
    """The stretch shows the place, the status tells it, and the cursor stands on the extreme itself."""
    place = example()["cases"][0]["places"]["1"][quantity]["position_m"]
    row = page.locator("li", has_text=quantity).first
    row.get_by_role("link", name=re.compile("^at ")).click()
    assert read_status(page) == f"{quantity} at {place:.1f}\N{NO-BREAK SPACE}m"
    start, end = read_stretch(page)
    assert start < place < end
    assert end - start < 61
    shown = page.locator(f"{FIGURE} .legend").first.locator("label").nth(1).inner_text()
    assert read_numbers(shown)[-1] == pytest.approx(extreme(TRACE["force_20_N"]), rel=2e-3)  # one sample beside it
    assert page.evaluate("document.activeElement.className") == "area"


def test_uplift_leads_to_its_support_and_time(page: Any) -> None:
    row = page.locator("li", has_text="max_uplift_at_support_mm").first
    row.get_by_role("link", name="at 300 m").click()
    assert read_status(page, 0, "#case-1-uplift") == "max_uplift_at_support_mm at 300\N{NO-BREAK SPACE}m"
    values = page.locator("#case-1-uplift .legend label", has_text="support at 300 m").inner_text()
    assert read_numbers(values)[-1] == pytest.approx(51.3, rel=2e-3)


def test_simulated_and_measured_force_stand_in_one_plot(open_page: Any) -> None:
    """The measured force of the example is 3 N higher everywhere; the values shown have four digits."""
    page = open_page("measured")
    figure = "#case-2-measured-1"
    page.locator(figure).scroll_into_view_if_needed()
    plot_area(page, 0, figure).press("ArrowRight")
    _, simulated, measured, difference = (read_numbers(part)[-1] for part in read_status(page, 0, figure).split(", "))
    assert_allclose((measured - simulated, difference), (3, -3), atol=0.11)
    _, (headings, *rows) = read_file(page, page.locator(figure), "Curves as CSV")
    assert headings == ["position_m", "simulated_N", "measured_N"]
    assert len(rows) == len(example()["cases"][1]["traces"]["1"]["position_m"])


def test_force_of_the_reference_is_drawn_and_saved_beside_that_of_the_system(open_page: Any) -> None:
    """The reference of the example is 2 N higher everywhere."""
    page = open_page("reference")
    figure = page.locator(FIGURE)
    figure.scroll_into_view_if_needed()
    assert figure.get_by_role("checkbox", name="reference, 0–20 Hz").count() == 1
    _, (headings, *rows) = read_file(page, figure, "Curves as CSV")
    assert headings == ["position_m", "force_N", "force_20_N", "reference_force_20_N"]
    assert all(float(row[3]) - float(row[2]) == pytest.approx(2, abs=1e-3) for row in rows)


def read_file(page: Any, scope: Any, name: str) -> tuple[str, list[list[str]]]:
    """Name and rows of the file that a button saves."""
    with page.expect_download() as download:
        scope.get_by_role("button", name=name, exact=True).click()
    with open(download.value.path(), encoding="utf-8", newline="") as file:
        return download.value.suggested_filename, list(csv.reader(file))


def test_curves_are_saved_with_all_their_digits(page: Any) -> None:
    name, (headings, *rows) = read_file(page, page.locator(FIGURE), "Curves as CSV")
    assert name == "en50318-2002-250-pantograph-1-force.csv"
    assert headings == ["position_m", "force_N", "force_20_N"]
    expected = zip(*(TRACE[heading] for heading in headings), strict=True)
    assert [tuple(map(float, row)) for row in rows] == list(expected)
    _, (headings, *rows) = read_file(page, page.locator("#case-1-uplift"), "Curves as CSV")
    assert headings == ["support_m", "time_s", "uplift_mm"]
    assert len(rows) == sum(len(support["time_s"]) for support in example()["cases"][0]["uplift"])


def test_quantities_are_saved_with_all_their_digits(page: Any, open_page: Any) -> None:
    _, (headings, *rows) = read_file(page, page, "Quantities as CSV")
    assert headings == ["case", "pantograph", "quantity", "item", "value", "uncertainty"]
    saved = {(row[0], row[1], row[2]): float(row[4]) for row in rows}
    assert saved == {
        (case["id"], owner, name): value
        for case in example()["cases"]
        for owner, quantities in case["quantities"].items()
        for name, value in quantities.items()
    }
    hostile = open_page("hostile")
    _, rows = read_file(hostile, hostile, "Quantities as CSV")
    assert {len(row) for row in rows} == {6}  # commas and quotes of a file do not add columns


def test_static_figure_stands_in_place_of_the_curves_on_request(page: Any) -> None:
    figure = page.locator(FIGURE)
    still = figure.locator("> div > svg")
    assert not still.is_visible()
    figure.get_by_role("button", name="Static figure").click()
    assert still.is_visible()
    assert not figure.locator("canvas").first.is_visible()


def test_curves_follow_a_change_to_the_dark_scheme(page: Any) -> None:
    before = plot_area(page).screenshot()
    page.emulate_media(color_scheme="dark")
    assert plot_area(page).screenshot() != before
    brightest = page.evaluate(
        """area => { const canvas = area.querySelector("canvas");
        const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return data.reduce((most, value, i) => i % 4 || data[i + 3] < 200 ? most : Math.max(most, value), 0); }""",
        plot_area(page).element_handle(),
    )
    assert brightest > 200  # the ink of the dark scheme is light


def test_fingers_move_and_zoom(open_page: Any) -> None:
    """One finger moves the stretch with it, two fingers twice as far apart halve it; a pixel is 0.4 m."""
    page = open_page("certificate", 390, has_touch=True)
    page.locator(f"{FIGURE} .area").first.scroll_into_view_if_needed()
    page.locator(f"{FIGURE} canvas").first.wait_for()
    box = page.locator(f"{FIGURE} .u-over").first.bounding_box()
    touch = page.context.new_cdp_session(page)
    start, end = read_stretch(page)

    def send(kind: str, *shares: float) -> None:
        points = [{"x": box["x"] + share * box["width"], "y": box["y"] + 60, "id": i} for i, share in enumerate(shares)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    send("touchStart", 0.4, 0.6)
    for step in (0.05, 0.1):
        send("touchMove", 0.4 - step, 0.6 + step)
    send("touchEnd")
    zoomed = read_stretch(page)
    assert_allclose(zoomed[1] - zoomed[0], (end - start) / 2, rtol=0.03)
    send("touchStart", 0.5)
    for step in (0.1, 0.2):
        send("touchMove", 0.5 - step)
    send("touchEnd")
    moved = read_stretch(page)
    assert_allclose(moved[0] - zoomed[0], 0.2 * (zoomed[1] - zoomed[0]), atol=1.5)
