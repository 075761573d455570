"""Simulated and measured run beside each other: same positions, statistics by span, both pantographs, and the page."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record, compare_measured_run, list_run_supports
from pantocheck.conformance.core.figure_data import Spectrum
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.run_comparison_page import comparison_blocks, force_difference, spectrum_difference
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable

SPAN = 60.0
SUPPORTS = np.arange(0.0, 601.0, SPAN)

Run = Callable[..., AssessedRecord]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Assessed record of two pantographs 100 m apart whose mean force grows by 1 N from span to span."""

    def assess(
        name: str, offset: float = 0.0, rate: float = 200.0, section: tuple[float, float] = (120.0, 480.0)
    ) -> AssessedRecord:
        time = np.arange(int(10.5 * rate)) / rate
        position = 100 + 60 * time - np.array([[0.0], [100.0]])
        force = 100 + offset + position // SPAN + np.array([[20.0], [30.0]]) * np.sin(2 * np.pi * position / 20)
        uplift = 0.05 * np.exp(-(((position[0] - SUPPORTS[:, None]) / 5) ** 2))
        record = Record(
            time=time, speed=60.0, position=position, force=force, evaluated=section, contact_height=0 * position,
            support_position=SUPPORTS, support_uplift=uplift,
        )  # fmt: skip
        path = write_record(tmp_path / f"{name}.csv", record, further={"line": {"span_m": SPAN}})
        return load_assessed_record(path, load_profile("line-test"), LineTable())

    return assess


@pytest.mark.parametrize("pantograph", ["1", "2"])
def test_forces_stand_at_the_same_positions(run: Run, pantograph: str) -> None:
    """An offset of 5 N is the difference at every position, though the measured record has another rate and section.

    1 N: the filter smooths the steps of 1 N at the supports over different numbers of samples.
    """
    simulated, measured = run("simulated"), run("measured", -5.0, 333.0, (180.0, 420.0))
    comparison = compare_measured_run(simulated, measured, list_run_supports(simulated))
    assert comparison is not None
    part = comparison.pantographs[pantograph]
    assert (part.position_m[0], len(part.spans)) == (pytest.approx(180.0, abs=0.3), 4)
    assert force_difference(part) == pytest.approx([5.0] * len(part.position_m), abs=1.0)


def test_each_span_has_its_own_statistics(run: Run) -> None:
    """Sine of three periods per span: its mean is 0, and its standard deviation 20 or 30 N over the root of 2.

    0.5 %: samples per span, and the steps of 1 N at its ends.
    """
    comparison = compare_measured_run(run("simulated"), run("measured", 10.0), SUPPORTS)
    assert comparison is not None
    for key, amplitude in (("1", 20.0), ("2", 30.0)):
        part = comparison.pantographs[key]
        assert part.simulated_spectrum != part.measured_spectrum
        spans = comparison.pantographs[key].spans
        assert [span.start_m for span in spans] == list(SUPPORTS[2:8])
        for number, span in enumerate(spans, 2):
            assert span.simulated.mean_N == pytest.approx(100 + number, abs=0.5)
            assert span.measured.mean_N - span.simulated.mean_N == pytest.approx(10.0, abs=0.01)
            assert span.measured.std_N == pytest.approx(amplitude / np.sqrt(2), rel=5e-3)


def test_runs_without_common_track_have_no_common_curves(run: Run) -> None:
    simulated, measured = run("simulated", section=(120.0, 240.0)), run("measured", section=(300.0, 420.0))
    comparison = compare_measured_run(simulated, measured, SUPPORTS)
    assert comparison is not None
    assert comparison.pantographs == {}
    assert compare_measured_run(simulated, replace(measured, prepared=None), SUPPORTS) is None
    simulated = Spectrum(frequency_Hz=[0.0, 1.0, 2.0, 3.0], amplitude_N=[1.0, 2.0, 3.0, 4.0])
    measured = Spectrum(frequency_Hz=[0.5, 2.5], amplitude_N=[1.0, 3.0])
    assert spectrum_difference(simulated, measured) == ([1.0, 2.0], [0.5, 0.5])


@pytest.mark.parametrize(
    ("own", "other", "refused"),
    [
        ((120.0, 480.0), (150.0, 450.0), False),  # half a span of 60 m at either end
        ((120.0, 480.0), (151.0, 480.0), True),
        ((120.0, 480.0), (120.0, 449.0), True),
        ((120.0, 480.0), (89.0, 480.0), True),
        ((120.0, 480.0), (120.0, 511.0), True),
        ((200.0, 260.0), (260.0, 320.0), True),  # the next span
        ((300.0, 350.0), (325.0, 375.0), False),  # half of 50 m, which is shorter than a span
        ((300.0, 350.0), (326.0, 376.0), True),
        ((300.0, 350.0), (300.0, 332.0), True),  # 18 m are more than half of 32 m
        ((300.0, 332.0), (300.0, 350.0), True),
    ],
)
def test_records_of_other_sections_are_refused(
    run: Run, own: tuple[float, float], other: tuple[float, float], refused: bool
) -> None:
    profile, records = load_profile("line-test"), (run("simulated", section=own), run("measured", 1.0, section=other))
    if not refused:
        assert assess_record(records[0], profile, "provisional", records[1]).cases
        return
    sections = f"measured run: {other[0]:g} to {other[1]:g} m; of the simulated run: {own[0]:g} to {own[1]:g} m"
    with pytest.raises(InputError, match=sections):
        assess_record(records[0], profile, "provisional", records[1])


def test_certificate_shows_both_runs(run: Run) -> None:
    """Overlay, spectra and spans of both pantographs; the results follow from their numbers."""
    results = assess_record(run("simulated"), load_profile("line-test"), "provisional", run("measured", 1.0))
    assert find_discrepancies(results) == []
    (section,) = comparison_blocks(results.cases[0], 0, "case-1")
    assert isinstance(section, doc.Section)
    values, figures, *spans = section.blocks[1:]
    assert isinstance(values, doc.Table)
    (mean, second) = [row for row in values.rows if row[0] == "Mean contact force"]
    assert (mean[1], mean[6], second[1], second[6]) == ("pantograph 1", "−1", "pantograph 2", "−1")
    assert isinstance(figures, doc.Figures)
    assert len(figures.figures) == 6
    assert [len(table.rows) for table in spans if isinstance(table, doc.Table)] == [6, 6]
