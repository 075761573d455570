"""Report on a population of tests, from population.json alone."""

import inspect
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes

from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.population_page import build_population_document, draw_test_boxes, draw_test_ratios
from pantocheck.conformance.results.population_format import (
    PooledGroup,
    PooledLevel,
    PooledRecord,
    PooledValue,
    PopulationFile,
    Variability,
)

RATIOS = {"A": (0.0050, 0.0030), "B": (0.0051, 0.0031), "C": (0.0049, 0.0029), "rope": (0.0080, 0.0045)}
"""Damping ratio of each test in groups 1 and 2."""


def build_population(tests: int) -> PopulationFile:
    """population.json of tests with the values of `RATIOS`, by turns; those of the rope are outliers."""
    names = [list(RATIOS)[t % 4] for t in range(tests)]
    records = tuple(
        PooledRecord(
            record=f"a long name of test {t} {name}",
            source=name,
            mass_kg=40.0,
            drop_wire="CW",
            drop_position_m=212.25,
            line={},
            sensors=("CW 195.75", "MW 272.25"),
            modes=2,
            certain=2,
            misfit=1.0,
            outliers_above=2 * (name == "rope"),
            outliers_below=0,
            suspicious=name == "rope",
            values=tuple(
                PooledValue(
                    group=group,
                    frequency_Hz=0.9 * group,
                    damping_ratio=ratio,
                    damping_ratio_std=1e-5,
                    joint_damping_ratio=None,
                    outlier="above" if name == "rope" else None,
                )
                for group, ratio in enumerate(RATIOS[name], 1)
            ),
        )
        for t, name in enumerate(names)
    )
    group = {"tests": tests, "values": tests, "outliers_above": 1, "outliers_below": 0, "test_spread": None}
    middle = {"lower_quartile": 0.0049, "median": 0.0050, "upper_quartile": 0.0051, "interval": (0.0049, 0.0051)}
    groups = tuple(
        PooledGroup(
            group=number,
            from_Hz=0.8 * number,
            to_Hz=number,
            joint_median=joint,
            joint_interval=None if joint is None else (0.0049, 0.0052),
            agrees=None if joint is None else True,
            **group,
            **middle,
        )
        for number, joint in ((1, 0.00505), (2, None))
    )
    content = PopulationFile(
        records=records,
        unusable=(),
        groups=groups,
        variability=Variability(
            groups=2, rank_correlation=-1.0, last_over_first=0.5, outliers=4, outliers_above_share=1.0
        ),
        levels=(PooledLevel(factor="mass", level="40 kg", tests=tests, medians={1: 0.005}),),
        warnings=("check the rope",),
    )
    return content


@pytest.fixture(scope="module")
def document() -> Document:
    return build_population_document(build_population(4))


def paint(draw: Any, *arguments: Any) -> Axes:
    """Panel of a figure before it is rendered."""
    (axes,) = inspect.unwrap(draw)(*arguments).axes
    return axes


def test_page_states_agreement_variability_and_outliers(document: Document) -> None:
    text = render_markdown(document)
    assert "4 tests identified one by one; the medians of 1 of 1 groups agree with the joint identification." in text
    assert "over 2 groups is −1.0" in text
    assert "0.50 times that of the first" in text
    assert "100 % of the 4 outliers lie above their box" in text
    assert "check the rope" in text
    assert "a long name of test 3 rope" in text
    assert "40 kg" in text


def test_outliers_are_dots_and_many_tests_have_numbers() -> None:
    """One outlier of the rope in each group; the joint median is a line over the width of its box."""
    population = build_population(4)
    axes = paint(draw_test_boxes, population.groups, population.records)
    dots = [line for line in axes.lines if line.get_marker() == "o"]
    assert [tuple(line.get_xydata()[0]) for line in dots] == [(1, pytest.approx(0.80)), (2, pytest.approx(0.45))]
    joint = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert [float(np.mean(line.get_ydata())) for line in joint] == [pytest.approx(0.505)]
    # Twelve tests with long names: numbers in the legend, which leaves the axes their size.
    population = build_population(12)
    axes = paint(draw_test_ratios, population.records)
    styles = {(line.get_marker(), line.get_color()) for line in axes.lines}
    assert len(styles) == 12
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [str(n) for n in range(1, 13)]
    assert draw_test_ratios(population.records).startswith("<svg")
