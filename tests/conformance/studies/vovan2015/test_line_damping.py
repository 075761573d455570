"""Damping of a line: every drop is simulated once, and damping ratios are drawn in percent."""

from types import SimpleNamespace

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.studies.vovan2015 import line_damping


def test_every_drop_of_a_case_is_simulated_and_identified(monkeypatch: pytest.MonkeyPatch) -> None:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    monkeypatch.setattr(
        line_damping, "simulate_drop", lambda case, number, line: SimpleNamespace(record=f"record {number}")
    )
    monkeypatch.setattr(line_damping, "identify_modes", lambda records, highest: [(records, highest)])
    identified = line_damping.identify_drops(case)
    assert len(identified.drops) == 3
    assert identified.identification == (("record 1", "record 2", "record 3"), case.file.mass_drop.highest_Hz)


def test_damping_ratios_are_drawn_in_percent_with_intervals_of_95_percent() -> None:
    """Half an interval has 1.96 standard deviations."""
    modes = [
        Mode(frequency_Hz=f, damping_ratio=ratio, damping_ratio_std=deviation, sensor_shape=())
        for f, ratio, deviation in ((1.0, 0.02, 0.001), (2.5, 0.0125, 0.0005))
    ]
    series = line_damping.draw_damping_ratios("identified", modes)
    assert (series.label, series.x, series.y) == ("identified", [1.0, 2.5], [2.0, 1.25])
    assert series.error == [0.196, 0.098]
