"""Figures as files: one SVG for each figure of a certificate in its order, and its points as numbers."""

import csv
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from helpers.example_results import chart, example
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.drawn_data import DrawnFigure, render_drawn_data
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.figure_files import write_figures
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.results.results_format import Results


def read_curve(path: Path, label: str) -> RealArray:
    """Points of a curve, (n, 2); NaN: an empty cell."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["curve"] == label]
    return np.array([[float(row[axis] or "nan") for axis in "xy"] for row in rows])


def test_every_figure_of_a_certificate_is_a_file_with_its_data(tmp_path: Path) -> None:
    """Points are printed with nine digits."""
    results = Results.model_validate(example())
    certificate = build_certificate(results)
    files = write_figures(certificate, tmp_path)
    drawings = [path for path in files if path.suffix == ".svg"]
    assert len(drawings) == render_html(certificate).count("<figure")
    assert sorted(tmp_path.iterdir()) == sorted(files)
    for path in drawings:
        assert ElementTree.parse(path).getroot().tag == "{http://www.w3.org/2000/svg}svg"
        assert path.with_suffix(".csv").is_file()
    [force] = tmp_path.glob("*-case-1-force-1.csv")
    trace = results.cases[0].traces["1"]
    expected = np.column_stack((trace.position_m, trace.force_N))
    np.testing.assert_allclose(read_curve(force, "unfiltered"), expected, rtol=1e-8)
    bands = next(iter(sorted(tmp_path.glob("*-force-by-frequency*.csv"))))
    values = [results.cases[0].quantities["1"][name] for name in ("rms_0_5_N", "rms_5_20_N", "rms_20_50_N")]
    np.testing.assert_allclose(read_curve(bands, "pantograph 1, value"), np.column_stack(([5, 20, 50], values)))


def test_names_of_files_are_those_of_the_english_figures(tmp_path: Path) -> None:
    certificate = build_certificate(Results.model_validate(example()))
    plain = write_figures(certificate, tmp_path / "en")
    german = write_figures(replace(certificate, language="de"), tmp_path / "de")
    assert [path.name for path in plain] == [path.name for path in german]
    assert any("Kontaktkraft" in path.read_text("utf-8") for path in german if path.suffix == ".svg")


def test_bars_and_lines_of_a_chart_are_its_data() -> None:
    data = Chart.model_validate(chart("measured", "Damping ratios"))
    drawn = draw_chart(data)
    assert isinstance(drawn, DrawnFigure)
    copied = deepcopy(drawn)  # in the way of a page that another process writes
    assert isinstance(copied, DrawnFigure)
    assert (copied, len(copied.data)) == (drawn, len(drawn.data))
    named = {part.label: part for part in drawn.data if part.label}
    series = data.series[0]
    np.testing.assert_allclose(named[series.label].y, series.y)
    assert render_drawn_data(drawn.data).startswith("panel,curve,x,y\n")
