"""Report on an identification: its figures and sentences, from identification.json alone."""

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from helpers.example_identification import build_example_line
from helpers.page_blocks import find_blocks
from pantocheck.conformance.core.figure_style import format_decade
from pantocheck.conformance.pages.document import Document, Paragraph
from pantocheck.conformance.pages.document import Figure as PageFigure
from pantocheck.conformance.pages.document import Figures as PageFigures
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.identification_figures import (
    draw_half_power,
    draw_order_search,
    draw_response_zoom,
    draw_responses,
    draw_spectra,
    draw_stretch,
)
from pantocheck.conformance.pages.identification_page import build_identification_document
from pantocheck.conformance.pages.record_figures import DrawnPlace, draw_drop_layout, draw_motion, draw_spectrogram
from pantocheck.conformance.pages.shape_figure import draw_shapes, list_measured_shapes, list_paired_rows
from pantocheck.conformance.results.damping_format import PairedShape
from pantocheck.conformance.results.identification_format import (
    IdentifiedLine,
    OrderSearch,
    OverlayRun,
    RecordResponses,
    RecordSpectra,
    Spectrogram,
)
from pantocheck.conformance.results.identified_modes import Mode


@pytest.fixture(scope="module")
def line() -> dict[str, Any]:
    return build_example_line()


@pytest.fixture(scope="module")
def document(line: dict[str, Any]) -> Document:
    return report(line)


def report(line: dict[str, Any]) -> Document:
    """Report on one line of identification.json."""
    return build_identification_document([IdentifiedLine.model_validate(line)])


def paint(draw: Callable[..., str], *arguments: Any) -> list[Axes]:
    """Panels of a figure before it is rendered."""
    painter: Callable[..., Figure] = inspect.unwrap(draw)
    return painter(*arguments).axes


def list_figures(document: Document) -> list[PageFigure]:
    return [figure for block in find_blocks(document.blocks, PageFigures) for figure in block.figures]


def list_sentences(document: Document) -> list[str]:
    return [str(block.text) for block in find_blocks(document.blocks, Paragraph)]


def test_every_figure_has_a_caption_and_another_alternative_text(document: Document) -> None:
    for figure in list_figures(document):
        assert figure.caption.endswith(".")
        assert figure.alternative.endswith(".")
        assert figure.alternative != figure.caption
        assert figure.svg.startswith("<svg")


@pytest.mark.usefixtures("fresh_figures")
def test_no_tick_shows_the_source_of_a_formula(line: dict[str, Any]) -> None:
    """A residual of less than one decade has ticks between the decades."""
    record = IdentifiedLine.model_validate(line).records[0]
    times = {"residual_time_s": [0.0, 1.0, 2.0], "residual_over_rest": [6.0, 1.2, 0.9]}
    assert "mathdefault" not in draw_stretch(record.model_copy(update=times))


def test_page_is_the_same_every_time(line: dict[str, Any], document: Document) -> None:
    assert render_html(report(line)) == render_html(document)


def test_half_power_bands_are_one_sentence_and_one_figure(line: dict[str, Any], document: Document) -> None:
    """Five lines in the narrowest band, that of the first mode, need 5 / (2 * 0.005 * 0.88) = 568 s."""
    assert not any("half-power" in warning for mode in line["modes"] for warning in mode["warnings"])
    sentences = [text for text in list_sentences(document) if "half-power" in text]
    assert len(sentences) == 1
    assert sentences[0].startswith("6 of 6 modes have fewer than 5 spectral lines in their half-power band; a linear ")
    assert "decay of 568 s" in sentences[0]
    (axes,) = paint(draw_half_power, [Mode.model_validate(mode) for mode in line["modes"]], 5)
    (points, recommended) = axes.lines
    np.testing.assert_allclose(points.get_ydata(), [mode["half_power_points"] for mode in line["modes"]])
    assert list(recommended.get_ydata()) == [5, 5]
    document = report(line | {"half_power": line["half_power"] | {"modes": 0}})
    assert not any("half-power" in text for text in list_sentences(document))


def test_spectra_of_repeats_are_not_drawn(line: dict[str, Any]) -> None:
    """Both records are in the JSON file; the page shows the first one of each drop, also if they have one name."""

    def list_captions(records: list[dict[str, Any]]) -> list[str]:
        figures = list_figures(report(line | {"records": records}))
        return [figure.caption for figure in figures if "spectrum of the free decay" in figure.caption]

    first, second = line["records"]
    assert [data["record"] for data in line["spectra"]] == ["run 1", "run 2"]
    shown = "run 1: spectrum of the free decay, the identified modes and the residual."
    assert list_captions([first, second]) == list_captions([first, second | {"name": "run 1"}]) == [shown]
    assert len(list_captions([first, second | {"mass_kg": 40.0}])) == 2
    moved = [sensor | {"position_m": 90.0} for sensor in second["sensors"]]
    assert len(list_captions([first, second | {"sensors": moved}])) == 2


def test_shapes_have_a_row_per_mode_with_the_real_parts(line: dict[str, Any]) -> None:
    """The first mode has 1 and 0.4 at the sensors. Rows have the distance 1, and the largest value of a row is 0.42."""
    columns = list_measured_shapes([Mode.model_validate(mode) for mode in line["modes"]])
    assert [(column.title, len(column.rows)) for column in columns] == [("group 1", 3), ("group 2", 3)]
    left, right = paint(draw_shapes, columns, [0.0, 60.0])
    assert [text.get_text() for text in left.get_yticklabels()] == ["0.8800 Hz", "0.9200 Hz", "0.9700 Hz"]
    (points,) = left.lines
    np.testing.assert_array_equal(points.get_xdata(), [20.0, 40.0] * 3)
    levels = np.repeat([0.0, -1.0, -2.0], 2)
    expected = [1.0, 0.4, -0.7 / 0.9, 1.0, 0.6 / 0.8, 1.0]
    np.testing.assert_allclose(points.get_ydata(), levels + 0.42 * np.array(expected), atol=1e-6)
    assert right.get_xlim() == (0.0, 60.0)
    # Uncertain and lateral modes are left out as well.
    mode = line["modes"][0]
    alone = mode | {"sensor_shape": mode["sensor_shape"][:1]}
    nowhere = mode | {"sensor_shape": [part | {"position_m": None} for part in mode["sensor_shape"]]}
    modes = [alone, nowhere, mode | {"certain": False}, mode | {"lateral": True}]
    assert list_measured_shapes([Mode.model_validate(mode) for mode in modes]) == []


def test_computed_shapes_are_drawn_with_the_measured_values() -> None:
    """Rows of damping.json: one curve per wire, markers of their own for the sensors of each wire."""
    curves = [{"wire": wire, "position_m": [0.0, 30.0, 60.0], "value": [0.0, 1.0, 0.0]} for wire in ("CW", "MW")]
    sensors = [{"wire": wire, "position_m": x, "value": 0.5} for wire, x in (("CW", 15.0), ("MW", 45.0))]
    shape = {"measured_Hz": 0.9, "group": 1, "mac": 0.9876, "sensors": sensors, "curves": curves}
    columns = list_paired_rows([PairedShape.model_validate(row) for row in (shape, shape | {"group": 2}, shape)])
    assert [(column.title, len(column.rows)) for column in columns] == [("group 1", 2), ("group 2", 1)]
    left, _ = paint(draw_shapes, columns, [0.0, 60.0])
    assert [text.get_text() for text in left.get_yticklabels()] == ["0.9000 Hz\nMAC 0.988"] * 2
    *drawn, contact, messenger = left.lines
    assert [line.get_linestyle() for line in drawn] == ["-", "--"] * 2
    np.testing.assert_allclose(drawn[2].get_ydata(), [-1.0, -1.0 + 0.42, -1.0])
    assert (contact.get_marker(), messenger.get_marker()) == ("o", "s")
    np.testing.assert_allclose(messenger.get_xydata(), [[45.0, 0.21], [45.0, -0.79]])


def test_zoom_shows_the_first_two_groups(line: dict[str, Any], document: Document) -> None:
    """From 10 % below the first mode to 10 % above the last one; the ticks are the modes."""
    data, modes = line["frequency_responses"][0], [mode["frequency_Hz"] for mode in line["modes"]]
    first, second = paint(draw_response_zoom, RecordResponses.model_validate(data), modes, (0.9 * 0.88, 1.1 * 1.93))
    measured, identified, ticks = first.lines
    assert first.get_xlim() == pytest.approx((0.792, 2.123))
    for curve in (measured, identified):
        assert 0.792 <= min(curve.get_xdata()) < 0.81
        assert 2.1 < max(curve.get_xdata()) <= 2.123
    np.testing.assert_allclose(ticks.get_xdata(), modes)
    assert second.get_ylabel().startswith("S2_z")
    assert any(figure.caption.endswith("the first 2 groups of span modes.") for figure in list_figures(document))


def test_motion_shows_velocity_and_acceleration_of_every_record(line: dict[str, Any]) -> None:
    """Rows: velocity, acceleration; columns: windows. The example of 80 s has both windows."""
    runs = line["overlays"][0]["runs"]
    panels = paint(draw_motion, [OverlayRun.model_validate(run) for run in runs])
    assert [axes.get_ylabel() for axes in panels] == ["velocity [m/s]", "", "acceleration [m/s²]", ""]
    keys = ("velocity_m_s", "velocity_m_s", "acceleration_m_s2", "acceleration_m_s2")
    for number, (axes, key) in enumerate(zip(panels, keys, strict=True)):
        assert [curve.get_label() for curve in axes.lines] == ["run 1", "run 2"]
        for curve, run in zip(axes.lines, runs, strict=True):
            np.testing.assert_array_equal(curve.get_ydata(), run["windows"][number % 2][key])
    # No window fits into a record of less than ten seconds: it has no figure.
    overlay = line["overlays"][0]
    short = {"channel": "S1_z", "runs": [{"name": "run 1", "windows": overlay["runs"][0]["windows"][:1]}]}
    document = report(line | {"overlays": [short]})
    (figure,) = [figure for figure in list_figures(document) if figure.caption.startswith("Velocity")]
    assert figure.caption == "Velocity and acceleration at S1_z, in the first ten seconds; low-passed at 6 Hz."
    none = {"channel": "S1_z", "runs": [{"name": "run 1", "windows": []}]}
    document = report(line | {"overlays": [none]})
    assert not any(figure.caption.startswith("Velocity") for figure in list_figures(document))


def test_order_search_is_drawn_with_its_steps_and_selected_orders(line: dict[str, Any], document: Document) -> None:
    """One band of two orders; the first pole of the second order is stable."""
    band = {"from_Hz": 0.3, "to_Hz": 1.3, "selected_order": 2, "order": [1, 2, 2], "frequency_Hz": [0.9, 0.9, 1.1]}
    steps = [{"name": "start poles", "frequency_Hz": [0.9, 1.1]}, {"name": "added", "frequency_Hz": [0.9, 1.0, 1.1]}]
    search = {"bands": [band | {"stable": [False, True, False]}], "steps": steps}
    lower, upper = paint(draw_order_search, OrderSearch.model_validate(search))
    assert [text.get_text() for text in upper.get_yticklabels()] == ["start poles: 2", "added: 3"]
    assert [list(row.get_ydata()) for row in upper.lines] == [[0, 0], [-1, -1, -1]]
    unstable, stable = lower.lines
    np.testing.assert_array_equal(stable.get_xydata(), [[0.9, 2.0]])
    np.testing.assert_array_equal(unstable.get_xydata(), [[0.9, 1.0], [1.1, 2.0]])
    (bar,) = lower.collections
    np.testing.assert_array_equal(bar.get_segments()[0], [[0.3, 2.0], [1.3, 2.0]])
    (figure,) = [
        figure for figure in list_figures(report(line | {"order_search": search})) if "model order" in figure.caption
    ]
    assert "start poles: 2 poles; added: 3 poles. Selected orders of the bands, by frequency: 2." in figure.alternative
    # The example has no search; poles placed by hand have none either.
    assert not any("model order" in figure.caption for figure in list_figures(document))


def test_spectrogram_marks_release_and_linear_decay(line: dict[str, Any], document: Document) -> None:
    """The linear decay of the example begins 1 s after the release and lasts to the end, 80 s after it."""
    (figure,) = [figure for figure in list_figures(document) if "spectrogram" in figure.caption]
    assert "left in windows of 4 s, right in windows of 1 s" in figure.caption
    assert "from 1.00 s to 80.00 s after the release" in figure.alternative
    marks = {"release": 0.0, "start of the linear decay": 1.0, "end of the linear decay": 80.0}
    whole, start, scale = paint(draw_spectrogram, Spectrogram.model_validate(line["spectrogram"]), marks, (-2.0, 80.0))
    # Each mark is drawn twice, on a white ground.
    assert [curve.get_xdata()[0] for curve in whole.lines] == [0.0, 0.0, 1.0, 1.0, 80.0, 80.0]
    assert [curve.get_xdata()[0] for curve in start.lines] == [0.0, 0.0, 1.0, 1.0]
    for axes, key in ((whole, "whole"), (start, "start")):
        part = line["spectrogram"][key]
        left, right, *_ = axes.images[0].get_extent()
        half = (part["time_s"][1] - part["time_s"][0]) / 2
        assert (left, right) == pytest.approx((part["time_s"][0] - half, part["time_s"][-1] + half))
        np.testing.assert_array_equal(axes.images[0].get_array(), np.array(part["level_dB"]).T)
    assert scale.get_ylabel() == "level [dB]"


def test_layout_shows_sensors_and_mass_on_their_wires(line: dict[str, Any], document: Document) -> None:
    """Two sensors on the contact wire, and one mass; the repeat has the same places and adds nothing."""
    (figure,) = [figure for figure in list_figures(document) if "masses" in figure.caption]
    assert figure.alternative == ("Line with 6 spans: S1_z on CW at 20 m; S2_z on CW at 40 m; 20 kg on CW at 100 m.")
    sensor = DrawnPlace("S3_z", "MW", 90.0)
    (axes,) = paint(draw_drop_layout, [60.0, 60.0], [sensor], [DrawnPlace("20 kg", "CW", 30.0)])
    marks = {curve.get_marker(): curve for curve in axes.lines if curve.get_marker() in ("s", "v")}
    # In the middle of a span the messenger wire is at its lowest, 0.6 of the height at a support.
    assert (*marks["s"].get_xdata(), *marks["s"].get_ydata()) == pytest.approx((90.0, 0.6))
    assert (*marks["v"].get_xdata(), *marks["v"].get_ydata()) == pytest.approx((30.0, -0.1))
    figures = list_figures(report(line | {"spans_m": []}))
    assert not any("masses" in figure.caption for figure in figures)


def test_names_in_figures_are_not_read_as_mathematics(line: dict[str, Any]) -> None:
    """Names of channels and records may hold dollar signs; as a formula, $_$ would be an error."""
    sensors = [DrawnPlace("$_$", "CW", 30.0)]
    assert draw_drop_layout([60.0], sensors, []).startswith("<svg")
    runs = [OverlayRun.model_validate(run | {"name": "$_$"}) for run in line["overlays"][0]["runs"]]
    assert draw_motion(runs).startswith("<svg")
    names = {"channels": ["$_$", "$^$"]}
    responses = RecordResponses.model_validate(line["frequency_responses"][0] | names)
    assert draw_response_zoom(responses, [0.9], (0.8, 2.0)).startswith("<svg")
    assert draw_responses(responses).startswith("<svg")
    assert draw_spectra(RecordSpectra.model_validate(line["spectra"][0] | names), "m/s²").startswith("<svg")


@pytest.mark.parametrize(("value", "text"), [(1e-3, "10⁻³"), (1.0, "10⁰"), (1e12, "10¹²"), (0.0, "0")])
def test_powers_of_ten_are_plain_text(value: float, text: str) -> None:
    assert format_decade(value) == text
