"""Moving picture of a passage: it agrees with the record, keeps its bound of size, and changes no force."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from pydantic import ValidationError

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.figure_data import LineShape
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_shape import build_line_shape
from pantocheck.conformance.quantities.bands import band_rms
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.motion_format import CodedField, MovingWire, PassageMotion, code_field
from pantocheck.conformance.runs import passage_motion
from pantocheck.conformance.runs.case_run import run_passage

FORCES = (120.0,)


def simulate(case: Case) -> tuple[Record, LineShape, PassageMotion]:
    discretisation = case.file.discretisation
    line = discretise_line(case.line, discretisation.element_m)
    shape = build_line_shape(case.line, case.analysed_spans, line)
    record = run_passage(case, line, discretisation, FORCES).record
    motion = passage_motion.build_passage_motion(case, line, shape, discretisation, record, FORCES)
    assert motion is not None
    return record, shape, motion


def test_graded_passage_with_frames_is_the_same_passage_and_gives_the_same_picture(case_250: Case) -> None:
    """Bit by bit: the steps stop at the frames, and go on from the same state."""
    record, shape, motion = simulate(case_250)
    discretisation = case_250.file.discretisation
    line = discretise_line(case_250.line, discretisation.element_m)
    stretch = passage_motion.plan_frames(case_250, line, shape, discretisation)
    assert stretch is not None
    run = run_passage(case_250, line, discretisation, FORCES, frames=stretch.request)
    assert run.frames is not None
    assert_array_equal(run.record.force, record.force)
    assert passage_motion.code_frames(case_250, line, stretch, run.frames, run.record) == motion


def test_picture_agrees_with_the_record(case_250: Case) -> None:
    """Rises within the stated error, head within its rounding of 0.05 mm, and the band by its RMS (2 % for 250 Hz)."""
    record, shape, motion = simulate(case_250)
    frames = motion.wires[0].rise_mm.frames
    at = np.searchsorted(record.time, motion.start_s + motion.step_s * np.arange(frames) - 1e-6)
    assert 1 / motion.step_s == pytest.approx(100)
    assert 0 < motion.error_mm < 5
    [contact] = [wire for wire in motion.wires if shape.side.curves[wire.curve].kind == "contact_wire"]
    rise = contact.rise_mm.decode()
    assert record.support_position is not None
    assert record.support_uplift is not None
    for place, uplift in zip(record.support_position, 1e3 * record.support_uplift, strict=True):
        drawn = np.array([np.interp(place, contact.x_m, row) for row in rise])
        assert_allclose(drawn, uplift[at], atol=motion.error_mm + 0.05)
    [pantograph] = motion.pantographs
    assert record.contact_height is not None
    assert len(pantograph.masses) == pantograph.height_mm.columns == 2
    assert_allclose(pantograph.height_mm.decode()[:, -1], 1e3 * record.contact_height[0, at], atol=0.051)
    signals = RecordSignals(record, case_250.file.filter).pantographs[1]
    assert_allclose(pantograph.force_N.decode()[:, 0], signals.force.graded[at], atol=0.026)
    assert pantograph.band_N is not None
    expected = band_rms(signals.delivered, record.rate, 20, 50)
    assert np.sqrt(np.mean(pantograph.band_N.decode() ** 2)) == pytest.approx(expected, rel=0.02)
    assert motion.slack is not None
    assert set(np.unique(motion.slack.decode())) == {0.0, 1.0}


def test_coarser_form_keeps_the_bound(case_250: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = simulate(case_250)[2]
    bound = len(whole.model_dump_json()) - 1
    monkeypatch.setattr(passage_motion, "MOST_LETTERS", bound)
    coarse = simulate(case_250)[2]
    assert len(coarse.model_dump_json()) <= bound < 400_000
    assert coarse.error_mm >= whole.error_mm - 0.1


def test_coded_field_is_exact_and_refuses_damage() -> None:
    """Numbers on the steps, the largest ones and missing ones come back; other data are refused."""
    chance = np.random.default_rng(5)
    values = 0.1 * chance.integers(-32000, 32000, (7, 5))
    values[0] = -0.1 * np.array([1, 2, 2**7, 2**14, 32000])
    values[2:4, 1:3] = np.nan
    coded = code_field(values, 0.1)
    assert_allclose(coded.decode(), values, atol=1e-9)
    assert_array_equal(np.isnan(coded.decode()), np.isnan(values))
    tree = coded.model_dump()
    for key, value in (("frames", 8), ("data", tree["data"][:-8]), ("data", "!" + tree["data"][1:]), ("step", 0.0)):
        with pytest.raises(ValidationError):
            CodedField.model_validate(tree | {key: value})
    with pytest.raises(ValidationError, match="4 and 5"):
        MovingWire(curve=0, x_m=[0.0, 1.0, 2.0, 3.0], rise_mm=coded)
