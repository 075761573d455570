"""Events of the line: an exclusion needs a reason, a kind that the profile permits, and a bounded share."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.profile_file import ExclusionRule, Profile, load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import apply_exclusions, load_assessed_record
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.records.events import RecordEvent, covered_share, list_events
from pantocheck.conformance.records.sidecar_tables import EventKind, LineTable
from pantocheck.conformance.results.results_format import CaseResult, Results

SPEED, PEAK_M = 70.0, 1200.0
TIME = np.arange(0, 40, 0.002)
POSITION = SPEED * TIME
"""2.8 km at 252 km/h."""


@pytest.fixture
def sidecar(tmp_path: Path) -> Path:
    """Two pantographs; both have a wave of up to 700 N at an overlap, which breaks sigma below 0.3 of the mean."""
    forces = []
    for behind in (0.0, 100.0):
        place = POSITION - behind
        noise = np.random.default_rng(5).standard_normal(TIME.size)
        peak = 700 * np.exp(-(((place - PEAK_M) / 15) ** 2)) * np.sin(2 * np.pi * (place - PEAK_M) / 20)
        forces.append(125 + 25 * np.sin(2 * np.pi * place / 61) + 5 * noise + peak)
    overlap = (np.abs(POSITION - PEAK_M) < 60).astype(float)
    columns = [TIME, POSITION, *forces, overlap]
    write_csv_table(tmp_path / "a.csv", ["t", "x", "F1", "F2", "overlap"], np.column_stack(columns), 9)
    (tmp_path / "a.toml").write_text("")
    units = {"time_s": ("t", "s"), "position_1_m": ("x", "m"), "force_1_N": ("F1", "N"), "force_2_N": ("F2", "N")}
    described = {key: {"column": name, "unit": unit} for key, (name, unit) in units.items()}
    keys = record_keys(speed_km_h=252.0, pantographs=2, spacing_m=[100.0], evaluated_m=[300.0, 2500.0])
    line = {"span_m": 61.0, "wave_speed_m_s": 120.0}
    return edit_toml(tmp_path / "a.toml", keys | {"line": line, "columns": described})


OVERLAP = {"kind": "overlap", "name": "U7", "from_m": 1140.0, "to_m": 1260.0, "exclude": "line test excludes overlaps"}


def own_profile(kinds: tuple[str, ...], share: float) -> Profile:
    """Profile of the user: the rules of the library on the force, and an exclusion."""
    content = load_profile("acceptance-ac").model_dump(mode="json", by_alias=True)
    content["rule"] = [rule for rule in content["rule"] if rule["quantity"] != "max_uplift_at_support_mm"]
    return Profile.model_validate({**content, "name": "own", "exclusion": {"kinds": kinds, "largest_share_pct": share}})


def assess(sidecar: Path, profile: Profile) -> tuple[Results, CaseResult]:
    results = assess_record(load_assessed_record(sidecar, profile, LineTable()), profile)
    return results, results.cases[0]


@pytest.mark.parametrize("source", ["list", "channel"])
def test_permitted_exclusion_leaves_the_overlap_out_and_is_stated(sidecar: Path, source: str) -> None:
    """The standard deviation without the overlap is that of the sine and the noise below 20 Hz, 17.7 N and 1 N."""
    event: dict[str, Any] = {"event": [OVERLAP]}
    if source == "channel":
        event = {"event_channel": [{"column": "overlap", "kind": "overlap", "exclude": "line test excludes overlaps"}]}
    edit_toml(sidecar, event)
    results, case = assess(sidecar, own_profile(("overlap",), 10.0))
    whole = assess(sidecar, load_profile("acceptance-ac"))[1]
    for owner in ("1", "2"):
        assert case.quantities[owner]["std_force_N"] == pytest.approx(17.75, abs=0.3)
        assert float(whole.quantities[owner]["std_force_N"]) > 30
        assert "uninterrupted" in case.skipped[owner]["rms_5_20_N"]
    assert case.verdict == "pass"
    assert whole.verdict == "fail"
    (fact,) = case.events
    assert (fact.kind, fact.excluded, fact.remark) == ("overlap", True, "line test excludes overlaps")
    assert fact.start_m == pytest.approx(1140, abs=0.2)
    assert fact.end_m == pytest.approx(1260, abs=0.2)
    (warning,) = [text for text in case.warnings if "left out" in text]
    assert warning.startswith("5.4")
    page = str(build_certificate(results).blocks)
    assert "stretches of the analysis section are left out" in page
    assert "Events of the line" in page


def test_event_of_a_channel_ends_at_its_last_marked_sample() -> None:
    channel = SimpleNamespace(kind="overlap", above=0.5, ahead_m=0.0, exclude=None, column="overlap")
    sidecar: Any = SimpleNamespace(event=(), event_channel=[channel])
    events = list_events(sidecar, np.arange(0.0, 60.0, 10.0), np.array([[1.0, 0.0, 1.0, 1.0, 0.0, 1.0]]))
    assert [(event.start, event.end) for event in events] == [(0.0, 0.0), (20.0, 30.0), (50.0, 50.0)]


def test_library_profile_permits_no_exclusion(sidecar: Path) -> None:
    """All numbers and the verdict are those of the record without events; the warning says why."""
    before = assess(sidecar, load_profile("acceptance-ac"))[1]
    edit_toml(sidecar, {"event": [OVERLAP]})
    after = assess(sidecar, load_profile("acceptance-ac"))[1]
    assert (after.verdict, after.quantities) == (before.verdict, before.quantities)
    assert before.events is None
    assert any("are evaluated: the profile permits no exclusion" in text for text in after.warnings)


@pytest.mark.parametrize(
    ("kinds", "share", "event"),
    [
        (("tunnel",), 10.0, {}),
        (("overlap",), 5.0, {}),
        (("overlap",), 10.0, {"exclude": None}),
        (("overlap",), 10.0, {"to_m": 1900.0}),
    ],
)
def test_exclusion_beyond_the_rule(sidecar: Path, kinds: tuple[str, ...], share: float, event: dict[str, Any]) -> None:
    """Another kind, a larger share, no reason: the whole section is evaluated."""
    stated = {key: value for key, value in {**OVERLAP, **event}.items() if value is not None}
    edit_toml(sidecar, {"event": [stated]})
    case = assess(sidecar, own_profile(kinds, share))[1]
    assert float(case.quantities["1"]["std_force_N"]) > 30
    assert case.verdict == "fail"
    assert not case.events[0].excluded


def test_every_event_is_decided_by_itself_and_overlapping_ones_count_once() -> None:
    """Two permitted stretches of 5 m in 100 m, one of another kind: 10 % are left out if the rule permits it."""
    stretches: list[tuple[EventKind, float]] = [("overlap", 10.0), ("tunnel", 20.0), ("overlap", 30.0)]
    events = [RecordEvent(kind, "", start, start + 5.0, "reason") for kind, start in stretches]
    for share, excluded in ((10.0, ((10.0, 15.0), (30.0, 35.0))), (9.9, ())):
        rule = ExclusionRule(kinds=("overlap",), largest_share_pct=share)
        found, facts, warnings = apply_exclusions(events, (0.0, 100.0), rule)
        assert found == excluded
        assert [fact.excluded for fact in facts] == [bool(excluded), False, bool(excluded)]
        assert any("the profile permits no exclusion of tunnel" in text for text in warnings)
    assert covered_share([(0, 10), (5, 15), (90, 200)], (0.0, 100.0)) == pytest.approx(0.25)


def test_kilometres_of_events_follow_the_direction(sidecar: Path) -> None:
    edit_toml(sidecar, {"track": {"zero_km": 50.0, "kilometres": "decreasing"}})
    edit_toml(
        sidecar, {"event": [{"kind": "tunnel", "from_km": 48.9, "to_km": 48.0}, {"kind": "switch", "from_km": 49}]}
    )
    table = (sidecar.parent / "a.csv").read_text().splitlines()
    rows = [line.split(",") for line in table[1:]]
    lines = [",".join([row[0], f"{50000 - float(row[1]):.3f}", *row[2:]]) for row in rows]
    (sidecar.parent / "a.csv").write_text("\n".join([table[0], *lines]))
    case = assess(sidecar, load_profile("acceptance-ac"))[1]
    places = [(event.kind, event.start_m, event.end_m) for event in case.events]
    assert places == [("switch", 1000.0, 1000.0), ("tunnel", pytest.approx(1100), pytest.approx(2000))]


@pytest.mark.parametrize(
    ("event", "message"),
    [
        ({"kind": "tunnel"}, "the place is missing"),
        ({"kind": "tunnel", "from_m": 1.0, "from_km": 1.0}, "the place is given twice"),
        ({"kind": "tunnel", "from_m": 5.0, "to_m": 1.0}, "the end is before the start"),
        ({"kind": "tunnel", "from_km": 5.0}, "the table track is missing"),
        ({"kind": "tunnel", "from_m": 5.0, "exclude": "because"}, "a place without length"),
    ],
)
def test_wrong_events_are_refused(sidecar: Path, event: dict[str, Any], message: str) -> None:
    edit_toml(sidecar, {"event": [event]})
    with pytest.raises(InputError, match=message):
        load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable())
