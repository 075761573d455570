"""Metamorphic rules of the verdict: no loss, shift, split or wrong scale of information turns a FAIL into a PASS.

The case has two pantographs 100 m apart. A sound record passes. The failing records differ from it in one fact: the
force of pantograph 2 varies too much, one support is lifted too far, at a passage or behind it, or the uplift has a
wrong zero. Order and units carry no information, so they change nothing.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.line_signals import UPLIFT_STRETCH_M
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.system import Delivered

RULE = settings(max_examples=4)

FAULTS = {
    "force of pantograph 2": "fail",
    "uplift of one support": "fail",
    "wave behind the last support": "fail",
    "zero of the uplift": "skip",
}


@pytest.fixture(scope="module")
def twin_case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """The 250 km/h case with a second pantograph, and every limit of the first for the second as well."""
    folder = tmp_path_factory.mktemp("twin")
    for name in ("line", "pantograph"):
        (folder / f"{name}.toml").write_bytes((library_folder() / "en50318-2002" / f"{name}.toml").read_bytes())
    file = read_toml(library_folder() / "en50318-2002" / "250.toml", "case")
    second = [{**limit, "pantograph": 2} for limit in file["limit"] if "pantograph" in limit]
    # The wave of the fixture has the mean and the sigma of a run, but neither its extremes nor its contact loss.
    limits = [e for e in (*file["limit"], *second) if e["quantity"] in {"mean_force_N", "std_force_N"}]
    uplift = [e for e in file["limit"] if e["quantity"] == "max_uplift_at_support_mm"]
    file |= {"id": "own/twin", "spacing_m": [100.0], "pantograph": 2 * file["pantograph"], "limit": limits + uplift}
    (folder / "twin.toml").write_text(tomli_w.dumps(file), encoding="utf-8")
    return load_case(folder / "twin.toml")


@dataclass(frozen=True)
class Subject:
    """Case and records: sound, and failing by fault."""

    case: Case
    sound: Record
    failing: dict[str, Record]

    def grade(self, record: Record) -> CaseResult:
        return grade_case(self.case, Delivered(record), "secondary")


@pytest.fixture(scope="module")
def subject(twin_case: Case, wave: Any) -> Subject:
    sound, strong = (wave(sigma=sigma, rate=250.0).record(twin_case) for sigma in (28.0, 34.0))
    start, end = sound.evaluated
    inside = np.flatnonzero((sound.support_position >= start) & (sound.support_position <= end))
    uplift = sound.support_uplift.copy()
    uplift[inside[1]] *= 2
    force = np.array([sound.force[0], strong.force[1]])
    height = np.array([sound.contact_height[0], strong.contact_height[1]])
    wave = sound.support_uplift.copy()
    wave[inside[-1]] += 0.06 * np.exp(-(((sound.position[1] - end - 40) / 5) ** 2))
    # The supports are lifted by 58 mm, more than the limit of 55 mm, and the sensors show 52 mm.
    offset = 1.16 * sound.support_uplift - 0.006
    failing = (
        replace(sound, force=force, contact_height=height),
        *(replace(sound, support_uplift=values) for values in (uplift, wave, offset)),
    )
    return Subject(twin_case, sound, dict(zip(FAULTS, failing, strict=True)))


def assert_no_pass(subject: Subject, change: Callable[[Record], Record]) -> None:
    """Every failing record, changed, has no PASS; a record that cannot exist is refused."""
    for fault, record in subject.failing.items():
        try:
            changed = change(record)
        except RecordInvalid:
            continue
        assert subject.grade(changed).verdict != "pass", fault


def test_the_sound_record_passes_and_the_others_fail(subject: Subject) -> None:
    assert subject.grade(subject.sound).verdict == "pass"
    assert [subject.grade(record).verdict for record in subject.failing.values()] == list(FAULTS.values())


@RULE
@given(kept=st.sets(st.integers(0, 10)))
def test_dropping_supports_gives_no_pass(subject: Subject, kept: set[int]) -> None:
    rows = sorted(kept)

    def drop(record: Record) -> Record:
        if not rows:
            return replace(record, support_position=None, support_uplift=None)
        return replace(
            record, support_position=record.support_position[rows], support_uplift=record.support_uplift[rows]
        )

    assert_no_pass(subject, drop)


@RULE
@given(share=st.tuples(st.floats(0, 1), st.floats(0, 1)))
@example(share=(0.02, 1.0))  # begins 7 m later, 73 m before the first support
@example(share=(0.2, 1.0))  # begins 8 m before it
@example(share=(0.0, 0.9))  # ends 24 m past the last one
def test_dropping_samples_at_the_ends_gives_no_pass(subject: Subject, share: tuple[float, float]) -> None:
    first, last = (int(part * subject.sound.time.size) for part in sorted(share))
    assume(last - first > 100)
    assert_no_pass(subject, lambda record: _select(record, np.s_[first:last]))


@RULE
@given(first=st.floats(0, 0.9), length=st.floats(0.001, 0.5))
def test_cutting_samples_out_gives_no_pass(subject: Subject, first: float, length: float) -> None:
    """The gap is closed: time runs on evenly, positions jump."""
    n = subject.sound.time.size
    kept = np.r_[0 : int(first * n), min(n, int((first + length) * n)) : n]
    assume(kept.size > 100)
    assert_no_pass(subject, lambda record: replace(_select(record, kept), time=record.time[: kept.size]))


@RULE
@given(kept=st.tuples(st.floats(0, 1), st.floats(0, 1)), support=st.integers(-1, 10))
def test_missing_uplift_gives_no_pass(subject: Subject, kept: tuple[float, float], support: int) -> None:
    """Uplift of one support, or of all (-1), outside a part of the record, is missing."""
    first, last = (int(part * subject.sound.time.size) for part in sorted(kept))

    def lose(record: Record) -> Record:
        uplift = record.support_uplift.copy()
        rows = slice(None) if support < 0 else slice(support, support + 1)
        uplift[rows, :first] = uplift[rows, last:] = np.nan
        return replace(record, support_uplift=uplift)

    assert_no_pass(subject, lose)


def test_uplift_that_does_not_count_may_be_missing(subject: Subject) -> None:
    """From 60 m behind the last pantograph on: the same verdicts and values, and no NaN in the result."""
    position = subject.sound.support_position
    behind = subject.sound.position.min(axis=0) > position[:, None] + UPLIFT_STRETCH_M
    assert behind.any(axis=1).sum() > 5
    for record, verdict in ((subject.sound, "pass"), *zip(subject.failing.values(), FAULTS.values(), strict=True)):
        whole, known = (
            subject.grade(replace(record, support_uplift=np.where(lost, np.nan, record.support_uplift)))
            for lost in (False, behind)
        )
        assert known.verdict == whole.verdict == verdict
        assert known.quantities == whole.quantities
        assert "NaN" not in known.model_dump_json()
        json.dumps(known.model_dump(mode="json"), allow_nan=False)


@pytest.mark.parametrize("dropped", ["height", "pantograph 1", "pantograph 2"])
def test_dropping_a_channel_gives_no_pass(subject: Subject, dropped: str) -> None:
    def drop(record: Record) -> Record:
        if dropped == "height":
            return replace(record, contact_height=None)
        row = [1] if dropped == "pantograph 1" else [0]
        return replace(
            record, position=record.position[row], force=record.force[row], contact_height=record.contact_height[row]
        )

    assert_no_pass(subject, drop)


@RULE
@given(shift=st.floats(-200, 200), channel=st.sampled_from(["position", "support_position", "pantograph 2"]))
def test_shifting_positions_gives_no_pass(subject: Subject, shift: float, channel: str) -> None:
    def move(record: Record) -> Record:
        if channel == "pantograph 2":
            return replace(record, position=record.position + np.array([[0.0], [shift]]))
        return replace(record, **{channel: getattr(record, channel) + shift})

    assert_no_pass(subject, move)


@RULE
@given(samples=st.integers(-2000, 2000), channel=st.sampled_from(["force", "contact_height", "support_uplift"]))
def test_shifting_a_channel_in_time_gives_no_pass(subject: Subject, samples: int, channel: str) -> None:
    assert_no_pass(
        subject, lambda record: replace(record, **{channel: np.roll(getattr(record, channel), samples, axis=1)})
    )


@RULE
@given(factor=st.floats(0.2, 5), channel=st.sampled_from(["force", "contact_height", "time", "position"]))
def test_rescaling_a_channel_gives_no_pass(subject: Subject, factor: float, channel: str) -> None:
    assert_no_pass(subject, lambda record: replace(record, **{channel: factor * getattr(record, channel)}))


@pytest.mark.parametrize(
    ("source", "channels"),
    [(0, ("force",)), (1, ("force",)), (1, ("force", "contact_height")), (1, ("force", "contact_height", "position"))],
)
def test_one_pantograph_for_both_gives_no_pass(subject: Subject, source: int, channels: tuple[str, ...]) -> None:
    """Pantograph 1 (row 0) is sound, so its force with its own height and another position would be another record."""
    rows = [source, source]
    assert_no_pass(subject, lambda record: replace(record, **{name: getattr(record, name)[rows] for name in channels}))


@RULE
@given(order=st.permutations(range(11)))
def test_the_order_of_supports_changes_nothing(subject: Subject, order: list[int]) -> None:
    record = subject.sound
    permuted = replace(
        record, support_position=record.support_position[order], support_uplift=record.support_uplift[order]
    )
    assert _numbers(subject.grade(permuted)) == _numbers(subject.grade(record))


@RULE
@given(
    chance=st.randoms(use_true_random=False),
    units=st.tuples(
        *(st.sampled_from(labels) for labels in (("s", "ms"), ("m", "km", "mm"), ("N", "kN"), ("m", "cm")))
    ),
    fault=st.sampled_from(["none", *FAULTS]),
)
def test_units_and_order_of_columns_change_nothing(
    subject: Subject, tmp_path_factory: pytest.TempPathFactory, chance: Any, units: tuple[str, ...], fault: str
) -> None:
    record = subject.failing.get(fault, subject.sound)
    folder = tmp_path_factory.mktemp("record")
    edit_toml(write_record(folder / "a.csv", record, case=subject.case.id), {"sha256": None})
    factors = {"s": 1.0, "ms": 1e-3, "m": 1.0, "km": 1e3, "mm": 1e-3, "cm": 1e-2, "N": 1.0, "kN": 1e3}
    channels = dict(zip(("time", "position", "force", "contact_height", "uplift"), (*units, units[1]), strict=True))
    values = (record.time, record.position, record.force, record.contact_height, record.support_uplift)
    columns = {
        f"{name}_{unit}" if name == "time" else f"{name}_{row}_{unit}": samples / factors[unit]
        for (name, unit), array in zip(channels.items(), values, strict=True)
        if array is not None
        for row, samples in enumerate(np.atleast_2d(array), 1)
    }
    names = chance.sample(list(columns), len(columns))
    write_csv_table(folder / "a.csv", names, np.column_stack([columns[name] for name in names]), 15)
    result = grade_case(subject.case, open_record_folder(folder).run(subject.case), "secondary")
    expected = subject.grade(record)
    assert result.verdict == expected.verdict
    assert _numbers(result) == pytest.approx(_numbers(expected), rel=1e-6)


def _select(record: Record, samples: Any) -> Record:
    """Record with some of its samples."""
    changes = {"time": record.time[samples]}
    for name in ("position", "force", "contact_height", "support_uplift"):
        changes[name] = getattr(record, name)[:, samples]
    return replace(record, **changes)


def _numbers(result: CaseResult) -> dict[str, float]:
    return {f"{item.quantity} {item.pantograph}": item.value for item in result.criteria if item.value is not None}
