"""Report on an identification: its figures and sentences, from identification.json alone."""

import inspect
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from helpers.example_identification import build_example_line
from pantocheck.conformance.reports.document import Block, Document, Paragraph, Section
from pantocheck.conformance.reports.document import Figure as PageFigure
from pantocheck.conformance.reports.document import Figures as PageFigures
from pantocheck.conformance.reports.figures.fixed_panels import format_power_of_ten
from pantocheck.conformance.reports.figures.half_power_figure import draw_half_power
from pantocheck.conformance.reports.formats.html import render_html
from pantocheck.conformance.reports.mass_drop.identification_report import build_identification_document


@pytest.fixture(scope="module")
def line() -> dict[str, Any]:
    return build_example_line()


@pytest.fixture(scope="module")
def document(line: dict[str, Any]) -> Document:
    return build_identification_document([line])


def paint(draw: Callable[..., str], *arguments: Any) -> list[Axes]:
    """Panels of a figure before it is rendered."""
    painter: Callable[..., Figure] = inspect.unwrap(draw)
    return painter(*arguments).axes


def list_blocks(blocks: tuple[Block, ...]) -> Iterator[Block]:
    for block in blocks:
        yield block
        if isinstance(block, Section):
            yield from list_blocks(block.blocks)


def list_figures(document: Document) -> list[PageFigure]:
    blocks = list_blocks(document.blocks)
    return [figure for block in blocks if isinstance(block, PageFigures) for figure in block.figures]


def list_sentences(document: Document) -> list[str]:
    return [str(block.text) for block in list_blocks(document.blocks) if isinstance(block, Paragraph)]


def test_every_figure_has_a_caption_and_another_alternative_text(document: Document) -> None:
    for figure in list_figures(document):
        assert figure.caption.endswith(".")
        assert figure.alternative.endswith(".")
        assert figure.alternative != figure.caption
        assert figure.svg.startswith("<svg")


def test_page_is_the_same_every_time(line: dict[str, Any], document: Document) -> None:
    assert render_html(build_identification_document([line])) == render_html(document)


def test_half_power_bands_are_one_sentence_and_one_figure(line: dict[str, Any], document: Document) -> None:
    """Five lines in the narrowest band, that of the first mode, need 5 / (2 * 0.005 * 0.88) = 568 s."""
    assert not any("half-power" in warning for mode in line["modes"] for warning in mode["warnings"])
    sentences = [text for text in list_sentences(document) if "half-power" in text]
    assert len(sentences) == 1
    assert sentences[0].startswith("6 of 6 modes have fewer than 5 spectral lines in their half-power band; a linear ")
    assert "decay of 568 s" in sentences[0]
    (axes,) = paint(draw_half_power, line["modes"], 5)
    (points, recommended) = axes.lines
    np.testing.assert_allclose(points.get_ydata(), [mode["half_power_points"] for mode in line["modes"]])
    assert list(recommended.get_ydata()) == [5, 5]


def test_results_without_counts_have_no_such_figure(line: dict[str, Any]) -> None:
    """An identification.json of an earlier version has no `half_power`."""
    document = build_identification_document([{key: value for key, value in line.items() if key != "half_power"}])
    assert not any("half-power" in text for text in list_sentences(document))


@pytest.mark.parametrize(("value", "text"), [(1e-3, "10⁻³"), (0.1, "0.1"), (1.0, "1"), (10.0, "10"), (1e12, "10¹²")])
def test_powers_of_ten_are_plain_text(value: float, text: str) -> None:
    assert format_power_of_ten(value) == text
