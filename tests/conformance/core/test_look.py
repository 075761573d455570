"""Colours of the look: contrast against the paper, distances that colour-blind readers see, one home for all users."""

import re
from itertools import combinations
from pathlib import Path
from typing import Any

import matplotlib.colors
import numpy as np
import pytest

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_style import CURVES, INK, read_style
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.texts import TEMPLATES

VISIONS = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
"""Linear RGB as a reader sees it: Machado, Oliveira, Fernandes (2009), A physiologically-based model for simulation of
color vision deficiency, IEEE TVCG 15(6), severity 1."""

TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""CIE XYZ of linear RGB, IEC 61966-2-1."""

WHITE = TO_XYZ.sum(1)

SMALLEST_DISTANCE = 20.0
"""CIE 1976 distance of two curves [-]: two neighbours of ten equal steps from black to white have 10."""


def find_linear(colour: str) -> RealArray:
    """Linear RGB of a colour, IEC 61966-2-1."""
    value = np.array(matplotlib.colors.to_rgb(colour))
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def find_lab(colour: str, vision: str) -> RealArray:
    """CIE 1976 L*a*b* of a colour for a vision."""
    xyz = TO_XYZ @ np.clip(VISIONS[vision] @ find_linear(colour), 0, 1) / WHITE
    root = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * root[1] - 16, 500 * (root[0] - root[1]), 200 * (root[1] - root[2])])


def find_distance(first: str, second: str, vision: str) -> float:
    return float(np.linalg.norm(find_lab(first, vision) - find_lab(second, vision)))


def find_contrast(first: str, second: str) -> float:
    """Contrast ratio of two colours [-], WCAG 2.1."""
    dark, light = sorted(float(TO_XYZ[1] @ find_linear(colour)) for colour in (first, second))
    return (light + 0.05) / (dark + 0.05)


def list_curves(scheme: str) -> list[str]:
    return [colour for name, colour in read_look()[scheme].items() if name.startswith("curve-")]


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_curves_differ_for_every_reader(scheme: str, vision: str) -> None:
    pairs = combinations(list_curves(scheme), 2)
    assert min(find_distance(*pair, vision) for pair in pairs) > SMALLEST_DISTANCE


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("scheme", ["light-verdict", "dark-verdict"])
def test_pass_and_fail_differ_for_every_reader(scheme: str, vision: str) -> None:
    """Their words and symbols differ as well."""
    accents = read_look()[scheme]
    assert find_distance(accents["pass"], accents["fail"], vision) > SMALLEST_DISTANCE


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_colours_have_contrast_against_the_paper(scheme: str) -> None:
    """WCAG AA requires 4.5 for small text, which curves have as well, and 3 for graphical objects."""
    look = read_look()
    colours, accents = look[scheme], look[f"{scheme}-verdict"]
    inks = [*accents.values(), *(colours[name] for name in ("ink", "soft", "link"))]
    assert min(find_contrast(ink, colours["paper"]) for ink in inks) > 5
    assert min(find_contrast(curve, colours["paper"]) for curve in list_curves(scheme)) > 4.5
    assert find_contrast(colours["faint"], colours["paper"]) > 3
    assert find_contrast(colours["ink"], colours["caution-paper"]) > 5


def test_figures_have_the_colours_of_the_look() -> None:
    """The style file stays usable by itself, so it repeats the colours of ink and curves."""
    style = read_style()
    assert {matplotlib.colors.to_hex(style[key]) for key in ("text.color", "axes.labelcolor")} == {INK}
    assert [matplotlib.colors.to_hex(colour) for colour in style["axes.prop_cycle"].by_key()["color"]] == list(CURVES)


def test_no_other_file_states_a_colour() -> None:
    """Style sheets, Typst, scripts and modules take them from the look; libraries have their own."""
    templates = [path for path in list_files(TEMPLATES) if path.suffix in (".css", ".typ", ".js")]
    modules = [path for path in list_files(Path(__file__).parents[3] / "conformance") if path.suffix == ".py"]
    stated = {
        path.name: found
        for path in (*templates, *modules)
        if not {"uplot", "pkijs"} & set(path.parts)
        and (found := re.findall(r"(?<![&\w])#(?:[0-9a-f]{6}|[0-9a-f]{3})\b(?!-)", path.read_text("utf-8")))
    }
    assert stated == {}


def list_files(folder: Any) -> list[Path]:
    return sorted(Path(str(folder)).rglob("*"))
