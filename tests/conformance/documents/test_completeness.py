"""Completeness: a record that lacks a part, or is of another train or version of the case, cannot pass."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.system import Delivered

UPLIFT, FORCES = "max_uplift_at_support_mm", ("mean_force_N", "std_force_N", "contact_loss_pct")


@pytest.fixture
def twin(two_pantograph_case: Case) -> Case:
    """Two pantographs 150 m apart, each with the limits of the case that a sine can meet."""
    limits = [limit for limit in two_pantograph_case.limits if limit.quantity in {UPLIFT, *FORCES}]
    rear = [limit.model_copy(update={"pantograph": 2}) for limit in limits if limit.owner]
    return replace(two_pantograph_case, limits=(*limits, *rear))


@pytest.fixture
def record(twin: Case) -> Record:
    """Run of that case within its limits."""
    return Wave(rate=200.0).record(twin)


def grade(case: Case, record: Record, case_digest: str | None = None) -> CaseResult:
    return grade_case(case, Delivered(record, case_digest=case_digest), "secondary")


def find_criterion(result: CaseResult, quantity: str) -> Criterion:
    return next(criterion for criterion in result.criteria if criterion.quantity == quantity)


def keep_supports(record: Record, kept: Any) -> Record:
    return replace(record, support_position=record.support_position[kept], support_uplift=record.support_uplift[kept])


def cut(record: Record, kept: Any) -> Record:
    """Record with some of its samples."""
    rows = ("position", "force", "contact_height", "support_uplift")
    return replace(record, time=record.time[kept], **{name: getattr(record, name)[:, kept] for name in rows})


def test_complete_record_passes_and_every_quantity_has_a_checked_need(twin: Case, record: Record) -> None:
    result = grade(twin, record)
    assert result.verdict == "pass", [result.reason, result.record, [c for c in result.criteria if c.verdict != "pass"]]
    assert {criterion.pantograph for criterion in result.criteria} == {0, 1, 2}
    for quantity in (*PANTOGRAPH_QUANTITIES, *LINE_QUANTITIES):
        with pytest.raises(AttributeError):  # no need is met by an object without signals
            quantity.needs.check(object())


@pytest.mark.parametrize("missing", [240.0, 300.0, 360.0])
def test_uplift_is_skipped_without_any_support_of_the_section(twin: Case, record: Record, missing: float) -> None:
    """The case is evaluated from 240 m to 360 m; the value of the other supports would pass."""
    result = grade(twin, keep_supports(record, record.support_position != missing))
    criterion = find_criterion(result, UPLIFT)
    assert (criterion.verdict, criterion.value) == ("skip", None)
    assert criterion.reason == f"the record has no uplift at 1 of 3 supports of the analysis section: {missing:g} m"
    assert result.verdict == "skip"


def test_support_with_a_dead_sensor_counts_as_missing_inside_the_section(twin: Case, record: Record) -> None:
    """A constant channel, for example of the support with the largest uplift, is no measurement of its uplift."""
    for held in (0.0, 0.012):
        uplift = np.where((record.support_position == 300.0)[:, None], held, record.support_uplift)
        criterion = find_criterion(grade(twin, replace(record, support_uplift=uplift)), UPLIFT)
        assert (criterion.verdict, criterion.value) == ("skip", None)
    inside = (record.support_position >= 240) & (record.support_position <= 360)
    assert grade(twin, keep_supports(record, inside)).verdict == "pass"


@pytest.mark.parametrize(("shift", "verdict"), [(0.001, "fail"), (-0.4, "fail"), (0.49, "fail"), (0.51, "skip")])
def test_support_at_the_section_limit_is_found_within_the_tolerance(
    twin: Case, record: Record, shift: float, verdict: str
) -> None:
    """The last support has 100 mm and is written at 360 m plus a shift: it must never leave the section unnoticed."""
    last = record.support_position == 360
    uplift = record.support_uplift * np.where(last, 2.0, 1.0)[:, None]
    shifted = replace(record, support_uplift=uplift, support_position=record.support_position + shift * last)
    criterion = find_criterion(grade(twin, shifted), UPLIFT)
    assert criterion.verdict == verdict
    assert criterion.value == (pytest.approx(100, rel=0.01) if verdict == "fail" else None)


@pytest.mark.parametrize(("spacing", "verdict"), [(150.4, "pass"), (149.6, "pass"), (150.6, "error"), (100, "error")])
def test_spacing_of_the_record_is_that_of_the_case(twin: Case, record: Record, spacing: float, verdict: str) -> None:
    """The rear pantograph alone is moved, with the force that it has at its place."""
    moved = replace(twin, file=twin.file.model_copy(update={"spacing_m": (float(spacing),)}))
    other = replace(Wave(rate=200.0).record(moved), evaluated=record.evaluated)
    result = grade(twin, other)
    assert result.verdict == verdict, result.reason
    if verdict == "error":
        assert result.reason == f"pantograph 2 runs {spacing:g} m behind pantograph 1 in the record, 150 m in the case"


def test_pantographs_that_part_or_stop_early_are_refused(twin: Case, record: Record) -> None:
    """Only the last samples differ, so that neither the first nor the mean distance shows it."""
    position = record.position.copy()
    position[1, -1] += 0.3
    position[0, -1] += 1.5
    assert "runs 151.2 m behind" in (grade(twin, replace(record, position=position)).reason or "")
    # Coverage counts for each pantograph: the first one has crossed the whole section.
    kept = record.position[1] < 350
    assert record.position[0][kept].max() > 400
    result = grade(twin, cut(record, kept))
    assert result.verdict == "error"
    assert "the record of pantograph 2 is cut short" in result.reason


@pytest.mark.parametrize(("end", "verdict"), [(362.0, "skip"), (416.0, "skip"), (418.5, "pass")])
def test_uplift_needs_the_record_behind_the_last_support(twin: Case, record: Record, end: float, verdict: str) -> None:
    """The section ends with the support at 360 m; the rear pantograph lifts it last. The run ends at 420 m."""
    criterion = find_criterion(grade(twin, cut(record, record.position[1] < end)), UPLIFT)
    assert criterion.verdict == verdict
    assert verdict == "pass" or "it must extend to 417.5 m" in criterion.reason


def test_record_of_another_version_of_the_case_is_refused(twin: Case, record: Record) -> None:
    assert grade(twin, record, twin.digest).verdict == "pass"
    older = replace(twin, file=twin.file.model_copy(update={"spacing_m": (151.0,)})).digest
    result = grade(twin, record, older)
    assert result.verdict == "error"
    assert result.reason.startswith("the record was made with other inputs than those of the case")
    assert grade(twin, record).record.case_digest is None
    assert grade(twin, record, twin.digest).record.case_digest == twin.digest


def write_files(folder: Path, case: Case, record: Record) -> Path:
    """Record with every channel and key: positions, times and a speed channel, spacing and start."""
    sidecar = write_record(folder / "run.csv", record, case.id, further={"case_digest": case.digest})
    rows = (folder / "run.csv").read_text().splitlines()
    speed = f"{record.speed:.9g}"
    (folder / "run.csv").write_text("\n".join([f"{rows[0]},speed_m_s", *(f"{row},{speed}" for row in rows[1:])]))
    start = float(record.position[0, 0])
    return edit_toml(sidecar, {"sha256": None, "spacing_m": [150.0], "start_m": start})


def remove_columns(table: Path, names: set[str]) -> None:
    rows = [line.split(",") for line in table.read_text().splitlines()]
    kept = [i for i, name in enumerate(rows[0]) if name not in names]
    table.write_text("\n".join(",".join(row[i] for i in kept) for row in rows))


def grade_files(case: Case, folder: Path) -> str:
    try:
        return run_case(case, open_record_folder(folder), "secondary").verdict
    except InputError:
        return "error"


KEYS = (
    "case", "case_digest", "speed_km_h", "pantographs", "evaluated_m", "filter_applied_Hz", "start_m", "spacing_m",
    "support_position_m",
)  # fmt: skip


def spoil_force(record: Record) -> Record:
    """The rear pantograph alone has too large a force."""
    return replace(record, force=record.force + np.array([[0.0], [12.0]]))


def spoil_uplift(record: Record) -> Record:
    """One support alone has too large an uplift."""
    return replace(record, support_uplift=record.support_uplift * (1 + (record.support_position == 300))[:, None])


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(spoil=st.sampled_from([spoil_force, spoil_uplift]), speed_alone=st.booleans(), data=st.data())
def test_removing_information_never_gives_a_pass(
    twin: Case,
    record: Record,
    tmp_path_factory: pytest.TempPathFactory,
    spoil: Callable[[Record], Record],
    speed_alone: bool,
    data: st.DataObject,
) -> None:
    """Any channels and keys are removed from a record that fails; with `speed_alone`, its positions as well."""
    folder = tmp_path_factory.mktemp("removed")
    sidecar = write_files(folder, twin, spoil(record))
    names = (folder / "run.csv").read_text().split("\n", 1)[0].split(",")
    columns = data.draw(st.sets(st.sampled_from(names), max_size=3))
    keys = data.draw(st.sets(st.sampled_from(KEYS), max_size=2))
    if speed_alone:
        columns |= {"position_1_m", "position_2_m"}
    if data.draw(st.booleans()):  # the sidecar no longer lists the support, so that the next one takes its number
        number = data.draw(st.integers(0, len(record.support_position) - 1))
        spoiled = keep_supports(spoil(record), np.arange(len(record.support_position)) != number)
        sidecar = write_files(folder, twin, spoiled)
    remove_columns(folder / "run.csv", columns)
    edit_toml(sidecar, dict.fromkeys(keys))
    assert grade_files(twin, folder) != "pass"


def test_record_without_one_support_never_passes(twin: Case, record: Record, tmp_path: Path) -> None:
    """The sidecar no longer lists it, so that the others take the numbers of its columns: neither of them is enough."""
    numbers = np.arange(len(record.support_position))
    verdicts = {}
    for number in numbers:
        write_files(tmp_path, twin, keep_supports(spoil_uplift(record), numbers != number))
        verdicts[int(number)] = grade_files(twin, tmp_path)
    assert "pass" not in verdicts.values(), verdicts


def test_same_files_pass_before_they_are_spoilt(twin: Case, record: Record, tmp_path: Path) -> None:
    write_files(tmp_path, twin, record)
    assert grade_files(twin, tmp_path) == "pass"
    for removed in ({"position_1_m", "position_2_m"}, {"time_s"}, {"speed_m_s"}, {"position_2_m"}):
        write_files(tmp_path, twin, record)
        remove_columns(tmp_path / "run.csv", removed)
        assert grade_files(twin, tmp_path) == "pass", removed


def test_record_with_time_alone_needs_the_places_of_its_pantographs(twin: Case, record: Record, tmp_path: Path) -> None:
    for key in ("spacing_m", "start_m (the first pantograph of the case starts at 210 m)"):
        sidecar = write_files(tmp_path, twin, record)
        remove_columns(tmp_path / "run.csv", {"position_1_m", "position_2_m"})
        edit_toml(sidecar, {key.split()[0]: None})
        result = run_case(twin, open_record_folder(tmp_path), "secondary")
        assert result.verdict == "error"
        assert f"channel position: missing, and the sidecar does not state {key}" in result.reason


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [((1.0, 1.0), "pass"), ((0.72, 0.72), "error"), ((0.9, 1.1), "error"), ((1.004, 1.0), "pass")],
)
def test_speed_channel_agrees_with_the_speed(
    twin: Case, record: Record, tmp_path: Path, factor: tuple[float, float], verdict: str
) -> None:
    """Factors of the two halves of the run: their mean may be right while both are wrong."""
    write_files(tmp_path, twin, record)
    rows = (tmp_path / "run.csv").read_text().splitlines()
    half = len(rows) // 2
    speeds = [record.speed * factor[i > half] for i in range(1, len(rows))]
    edited = [f"{row.rpartition(',')[0]},{speed:.9g}" for row, speed in zip(rows[1:], speeds, strict=True)]
    (tmp_path / "run.csv").write_text("\n".join([rows[0], *edited]))
    result = run_case(twin, open_record_folder(tmp_path), "secondary")
    assert result.verdict == verdict, result.reason
    if verdict == "error":
        assert "speed" in result.reason
        assert "the sidecar states 250 km/h" in result.reason
