"""The moving picture in a browser: instants, keys, playing, dragging, less motion, the drawn wire, and its look.

The stored pictures are written anew by `PANTOCHECK_STORE_PICTURES=1 pytest tests/browser/test_passage_view.py`.
"""

import io
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from helpers.example_passage import FRAMES, LOWEST_FRAME, STEP_S

pytestmark = pytest.mark.thorough

FIGURE = "#case-1-passage"
START_S = 2.0
LAST_S = START_S + (FRAMES - 1) * STEP_S
MODES = "#shapes-1"
PICTURES = Path(__file__).parents[1] / "data" / "pictures"

SMALLEST_FRAMES_PER_S = 20
"""Pictures a second that a playing passage needs at least; a free machine shows 60."""


def read_time(page: Any) -> float:
    found = re.match(r"t = ([\d.]+) s", page.locator(f"{FIGURE} .readout").inner_text())
    assert found is not None
    return float(found[1])


def open_at(open_page: Any, address: str = "", **options: Any) -> Any:
    page = open_page("passage", **options)
    page.evaluate("address => { location.hash = address; }", address)
    page.locator(FIGURE).scroll_into_view_if_needed()
    page.locator(f"{FIGURE} .readout", has_text="t = ").wait_for()
    return page


def find_wire(page: Any) -> list[float]:
    """Highest dark pixel of the side view below its middle, at each hundredth of the width: the contact wire [px]."""
    script = """figure => {
      const canvas = document.querySelector(`${figure} canvas`);
      const ratio = canvas.width / canvas.clientWidth;
      const [top, rows] = [Math.round(80 * ratio), Math.round(110 * ratio)];
      const { data } = canvas.getContext("2d").getImageData(0, top, canvas.width, rows);
      const isDark = (x, y) => data[4 * (y * canvas.width + x) + 3] > 200 && data[4 * (y * canvas.width + x)] < 90;
      return Array.from({ length: 100 }, (_, n) => {
        const x = Math.round((50 + (n / 100) * (canvas.clientWidth - 58)) * ratio);
        for (let y = 0; y < rows; y++) if (isDark(x, y)) return 80 + y / ratio;
        return NaN;
      });
    }"""
    return list(map(float, page.evaluate(script, FIGURE)))


def test_address_names_an_instant_and_steps_move_by_frames(open_page: Any) -> None:
    page = open_at(open_page, "t=2.503")
    assert read_time(page) == pytest.approx(2.503, abs=6e-4)
    assert "slack droppers: 1" in page.locator(f"{FIGURE} .readout").inner_text()
    area = page.locator(f"{FIGURE} .scene")
    area.press("ArrowRight")
    assert read_time(page) == pytest.approx(2.51)
    area.press("Shift+ArrowLeft")
    assert read_time(page) == pytest.approx(2.41)
    assert "slack droppers: 0" in page.locator(f"{FIGURE} [role=status]").last.text_content()
    area.press("End")
    assert read_time(page) == pytest.approx(LAST_S)
    area.press("Home")
    assert read_time(page) == pytest.approx(START_S)
    page.get_by_role("button", name="Link to this instant").click()
    assert page.evaluate("location.hash") == "#t=2.000"


def test_smallest_force_is_found(open_page: Any) -> None:
    page = open_at(open_page)
    page.get_by_role("button", name="Smallest force").click()
    assert read_time(page) == pytest.approx(START_S + LOWEST_FRAME * STEP_S)
    assert ", 40 N" in page.locator(f"{FIGURE} .readout").inner_text()


def test_smallest_force_is_found_before_the_picture_is_drawn(open_page: Any) -> None:
    page = open_page("passage")
    assert page.locator(f"{FIGURE} .readout").text_content() == ""
    page.evaluate("figure => document.querySelector(`${figure} button[title='Smallest force']`).click()", FIGURE)
    page.locator(f"{FIGURE} .readout", has_text=", 40 N").wait_for()
    assert read_time(page) == pytest.approx(START_S + LOWEST_FRAME * STEP_S)


def test_playing_and_dragging_change_the_instant(open_page: Any) -> None:
    page = open_at(open_page)
    area = page.locator(f"{FIGURE} .scene")
    area.press("Space")
    page.wait_for_timeout(600)
    area.press("Space")
    stopped = read_time(page)
    assert START_S < stopped < LAST_S
    page.wait_for_timeout(200)
    assert read_time(page) == stopped
    box = area.bounding_box()
    page.mouse.click(box["x"] + 50 + 0.5 * (box["width"] - 58), box["y"] + 330)
    assert read_time(page) == pytest.approx((START_S + LAST_S) / 2, abs=0.01)


def test_less_motion_shows_single_pictures(open_page: Any) -> None:
    """Two pictures in a second at a tenth of the speed: steps of 0.05 s."""
    page = open_at(open_page, reduced_motion="reduce")
    assert read_time(page) == START_S
    page.locator(f"{FIGURE} .scene").press("Space")
    page.wait_for_timeout(250)
    assert read_time(page) == START_S
    page.wait_for_timeout(600)
    assert read_time(page) > START_S + 0.04


def test_drawn_wire_follows_its_rise(open_page: Any) -> None:
    """The bump of 50 mm is 5 times enlarged; the room of the heights is that of the scene. Lines are 2.4 px wide."""
    heights = find_wire(open_at(open_page, "t=2.5"))
    room = 230 - 44 - 30 * 2
    rest = 6 + 26 + room
    assert heights[10] == pytest.approx(rest, abs=2)
    assert min(heights[15:85]) == pytest.approx(rest - 5 * 0.05 * room / 1.2, abs=3)


@pytest.mark.parametrize("width", [390, 768, 1440])
def test_picture_fits_the_width(open_page: Any, width: int) -> None:
    page = open_at(open_page, "t=2.5", width=width)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.locator(f"{FIGURE} canvas").bounding_box()["width"] <= width


def test_playing_picture_is_fluent(open_page: Any) -> None:
    page = open_at(open_page)
    rate = page.evaluate(
        """async figure => {
          document.querySelector(`${figure} button[title="Play"]`).click();
          const start = performance.now();
          let count = 0;
          await new Promise(done => {
            const tick = () => (++count, performance.now() - start < 1000 ? requestAnimationFrame(tick) : done());
            requestAnimationFrame(tick);
          });
          return (1000 * count) / (performance.now() - start);
        }""",
        FIGURE,
    )
    assert rate > SMALLEST_FRAMES_PER_S


def test_mode_shapes_move_one_by_one(open_page: Any) -> None:
    """A mode of 0.92 Hz and 0.48 % begins with 100 % at a sensor; half a period later it has the opposite shape."""
    page = open_page("identification")
    page.locator(MODES).scroll_into_view_if_needed()
    readout = page.locator(f"{MODES} .readout")
    readout.filter(has_text="t = ").wait_for()
    page.locator(f"{MODES} select").first.select_option(label="0.9200 Hz, ζ 0.4800 %, group 1")
    page.wait_for_timeout(300)
    first = [float(value) for value in re.findall(r": (-?[\d.]+)", readout.inner_text().replace("−", "-"))]
    assert max(map(abs, first)) == pytest.approx(100, abs=0.1)
    for _ in range(12):
        page.locator(f"{MODES} .scene").press("ArrowRight")
    second = [float(value) for value in re.findall(r": (-?[\d.]+)", readout.inner_text().replace("−", "-"))]
    assert second == pytest.approx([-value * np.exp(-0.0048 * np.pi) for value in first], abs=0.3)
    assert readout.inner_text().startswith(f"t = {0.5 / 0.92:.3f} s")


def take_picture(page: Any, figure: str) -> Any:
    """Canvas of a figure as a small picture in colours, (60, 120, 3)."""
    shot = page.locator(f"{figure} canvas").first.screenshot()
    return Image.open(io.BytesIO(shot)).convert("RGB").resize((120, 60), Image.Resampling.BOX)


@pytest.mark.parametrize(
    ("name", "width", "scheme"),
    [("passage", 1440, "light"), ("passage", 390, "dark"), ("identification", 768, "light")],
)
def test_picture_looks_like_the_stored_one(open_page: Any, name: str, width: int, scheme: str) -> None:
    """Mean difference of a colour below 4 of 255: other fonts change less; the other scheme changes more than 50."""
    page, figure = open_page(name, width, color_scheme=scheme), FIGURE if name == "passage" else MODES
    page.locator(figure).scroll_into_view_if_needed()
    page.locator(f"{figure} .readout", has_text="t = ").wait_for()
    for _ in range(4):
        page.locator(f"{figure} .scene").press("Shift+ArrowRight")
    taken, path = take_picture(page, figure), PICTURES / f"{name}-{width}-{scheme}.png"
    if os.environ.get("PANTOCHECK_STORE_PICTURES"):
        path.parent.mkdir(exist_ok=True)
        taken.save(path, optimize=True)
    stored = np.asarray(Image.open(path), float)
    assert np.abs(np.asarray(taken, float) - stored).mean() < 4
    page.emulate_media(color_scheme="dark" if scheme == "light" else "light")
    assert np.abs(np.asarray(take_picture(page, figure), float) - stored).mean() > 50


def test_compared_passages_move_at_the_same_place(open_page: Any) -> None:
    """The second passage begins one frame later with the same forces: at the lowest force of the first, both have 40 N.

    Wires and curves of the second have a colour of their own, #9f4d00.
    """
    page = open_page("compared")
    figure = page.locator("#scene-1")
    figure.scroll_into_view_if_needed()
    page.locator("#scene-1 .readout", has_text="t = ").wait_for()
    figure.get_by_role("button", name="Smallest force").click()
    readout = page.locator("#scene-1 .readout").inner_text()
    assert re.search(r"pantograph 1: .*, 40 N .*; second: 40 N;", readout)
    assert page.locator("#scene-1 .tools select").count() == 3  # no choice of one of the two motions
    tones = page.evaluate(
        """() => {
          const canvas = document.querySelector("#scene-1 canvas");
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const numbers = Array.from({ length: data.length / 4 }, (_, n) => 4 * n);
          return numbers.filter(i => data[i] === 159 && data[i + 1] === 77).length;
        }"""
    )
    assert tones > 500
