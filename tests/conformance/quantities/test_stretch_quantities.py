"""Quantities outside of overlaps: the samples inside are left out after the filter, and nothing else changes."""

import numpy as np
import pytest

from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.stated_quantities import (
    OVERLAP_QUANTITIES,
    evaluate_outside_overlaps,
    name_outside_overlaps,
)
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals

LOW_PASS = Filter()
POSITION = np.arange(0.0, 600.0, 0.05)
FORCE = 120 + 20 * np.sin(2 * np.pi * POSITION / 11.0) + np.where((POSITION >= 200) & (POSITION < 260), 80.0, 0.0)
"""Force at 50 m/s and 1000 samples per second, 4.5 Hz; from 200 m to 260 m, in the overlap, it is higher."""


def signals(section: tuple[float, float] = (100.0, 500.0)) -> dict[int, PantographSignals]:
    return {1: PantographSignals(POSITION, ForceChannel(FORCE, 1000.0, LOW_PASS), section)}


def test_values_are_those_of_the_filtered_force_without_the_overlaps() -> None:
    """Two overlaps, 195 m to 265 m and from 480 m on: statistics of the other samples, by hand."""
    values, skipped = evaluate_outside_overlaps(signals(), [(195.0, 265.0), (480.0, 540.0)])
    kept = ((POSITION >= 100.0) & (POSITION < 195.0)) | ((POSITION >= 265.0) & (POSITION < 480.0))
    graded = LOW_PASS(FORCE, 1000.0)[kept]
    assert values[1]["mean_force_outside_overlaps_N"] == pytest.approx(FORCE[kept].mean(), rel=1e-12)
    assert values[1]["std_force_outside_overlaps_N"] == pytest.approx(graded.std(), rel=1e-12)
    assert values[1]["max_force_outside_overlaps_N"] == pytest.approx(graded.max(), rel=1e-12)
    assert values[1]["min_force_outside_overlaps_N"] == pytest.approx(graded.min(), rel=1e-12)
    assert values[1]["contact_loss_outside_overlaps_pct"] == 0.0
    assert skipped == {1: {}}
    assert set(values[1]) == {quantity.name for quantity in OVERLAP_QUANTITIES}
    assert values[1]["max_force_outside_overlaps_N"] < 145 < LOW_PASS(FORCE, 1000.0).max()


@pytest.mark.parametrize("overlaps", [[], [(0.0, 100.0)], [(500.0, 580.0)]])
def test_section_without_an_overlap_has_no_such_quantities(overlaps: list[tuple[float, float]]) -> None:
    assert evaluate_outside_overlaps(signals(), overlaps) == ({1: {}}, {1: {}})


def test_section_without_an_overlap_or_inside_one_has_no_values() -> None:
    values, skipped = evaluate_outside_overlaps(signals((200.0, 250.0)), [(150.0, 300.0)])
    assert values == {1: {}}
    assert set(skipped[1].values()) == {"the whole analysis section lies inside overlaps or excluded stretches"}
    assert len(skipped[1]) == len(OVERLAP_QUANTITIES)
    assert name_outside_overlaps("contact_loss_pct") == "contact_loss_outside_overlaps_pct"
    assert {QUANTITIES[quantity.name].unit for quantity in OVERLAP_QUANTITIES} == {"N", "%"}


def test_record_has_them_beside_the_quantities_of_the_whole_section() -> None:
    """Over the analysis section and over a shifted one; without overlaps nothing is added."""
    record = Record(np.arange(POSITION.size) / 1000.0, 50.0, POSITION[None], FORCE[None], (100.0, 500.0))
    plain, stretched = RecordSignals(record, LOW_PASS), RecordSignals(record, LOW_PASS, None, ((195.0, 265.0),))
    added = {name: stretched.evaluation.values[1][name] for name in map(name_outside_overlaps, ("std_force_N",))}
    assert added["std_force_outside_overlaps_N"] < 0.6 * plain.evaluation.values[1]["std_force_N"]
    both = stretched.evaluation.values[1]
    assert {name: both[name] for name in plain.evaluation.values[1]} == plain.evaluation.values[1]
    shifted = stretched.evaluate_section((150.0, 500.0)).values[1]
    expected, _ = evaluate_outside_overlaps(signals((150.0, 500.0)), [(195.0, 265.0)])
    assert {name: shifted[name] for name in expected[1]} == expected[1]
