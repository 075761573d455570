"""Arc detectors and currents of a logger file, and their criterion in a profile."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.profile_file import Profile, load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.results_format import Results

RATE, SPEED = 1000.0, 70.0
TIME = np.arange(30_000) / RATE
CURRENT = {"column": "I", "unit": "kA"}
ARC = {"pantograph": 1, "detector": "UV", "above": 2.5, "current": CURRENT, "nominal_current_A": 600.0}


@pytest.fixture
def sidecar(tmp_path: Path) -> Path:
    """Pantograph 1 arcs for 5 ms each second; its current is above 30 % of 600 A from 10 s on. Losses at 1 Hz."""
    arc = np.where(TIME % 1 < 0.0049, 4.8, 0.1)
    current = np.where(TIME < 10, 0.05, 0.45)
    force = np.array([[120.0], [125.0]]) + 20 * np.sin(2 * np.pi * 1.1 * TIME)
    force[1, TIME % 1 < 0.0119] = 0.0
    columns = [TIME, SPEED * TIME, *force, arc, current]
    write_csv_table(tmp_path / "a.csv", ["t", "x", "F1", "F2", "UV", "I"], np.column_stack(columns), 9)
    (tmp_path / "a.toml").write_text("")
    units = {"time_s": ("t", "s"), "position_1_m": ("x", "m"), "force_1_N": ("F1", "N"), "force_2_N": ("F2", "N")}
    described = {key: {"column": name, "unit": unit} for key, (name, unit) in units.items()}
    keys = record_keys(speed_km_h=252.0, pantographs=2, spacing_m=[200.0], evaluated_m=[350.0, 1750.0])
    return edit_toml(tmp_path / "a.toml", keys | {"arc": [ARC], "columns": described})


def assess(sidecar: Path, *rules: dict[str, Any]) -> Results:
    """Results by a profile of the user with these rules."""
    base = load_profile("acceptance-ac").model_dump(mode="json", by_alias=True)
    own = {**base, "name": "own", "rule": rules, "shortest_contact_loss_s": 0.005}
    profile = Profile.model_validate(own)
    return assess_record(load_assessed_record(sidecar, profile, LineTable()), profile)


RULE = {"trust": "primary", "source": "contract"}


def test_arc_share_is_graded_and_contact_losses_are_listed(sidecar: Path) -> None:
    """5 of 1000 ms with arcs, in the loaded time as well; the section lasts 20 s: 20 losses of 12 ms."""
    rules = [
        {"quantity": "arc_share_pct", "upper": 0.6, **RULE},
        {"quantity": "longest_contact_loss_s", "upper": 0.01, **RULE},
        {"quantity": "long_contact_loss_pct", "upper": 2.0, **RULE},
        {"quantity": "contact_loss_events", "upper": 25.0, **RULE},
    ]
    results = assess(sidecar, *rules)
    (case,) = results.cases
    values = case.quantities
    assert values["1"]["arc_share_pct"] == pytest.approx(0.5, abs=0.05)
    assert values["1"]["contact_loss_events"] == 0
    assert values["2"]["longest_contact_loss_s"] == pytest.approx(0.012)
    assert values["2"]["contact_loss_events"] == pytest.approx(20)
    assert values["2"]["long_contact_loss_pct"] == pytest.approx(1.2, abs=0.01)
    verdicts = {(item.quantity, item.pantograph): item.verdict for item in case.criteria}
    assert verdicts["arc_share_pct", 1] == "pass"
    assert verdicts["arc_share_pct", 2] == "skip"
    assert verdicts["longest_contact_loss_s", 2] == "fail"
    assert verdicts["long_contact_loss_pct", 2] == "pass"
    assert case.uncertainty["2"]["longest_contact_loss_s"] is not None
    assert len(case.contact_losses["2"]) == 20
    assert "1" not in case.contact_losses
    loss = case.contact_losses["2"][0]
    assert (loss.position_m, loss.lowest_force_N) == (pytest.approx(360.0, abs=0.2), 0.0)
    page = str(build_certificate(results).blocks)
    assert "20 contact losses in the unfiltered force" in page


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        # Without the current, the share of the whole time would be too small.
        ({"arc": [{"pantograph": 1, "detector": "UV", "above": 2.5}]}, "the current is not known"),
        ({"evaluated_m": [350.0, 9000.0]}, "the record covers"),
    ],
)
def test_arc_share_needs_the_current_and_the_section(sidecar: Path, keys: dict[str, Any], reason: str) -> None:
    edit_toml(sidecar, keys)
    (case,) = assess(sidecar, {"quantity": "arc_share_pct", "upper": 5.0, **RULE}).cases
    assert case.verdict == "skip"
    assert reason in case.skipped["1"]["arc_share_pct"]


def test_filtered_force_lists_no_losses(sidecar: Path) -> None:
    edit_toml(sidecar, {"filter_applied_Hz": 20.0})
    (case,) = assess(sidecar, {"quantity": "longest_contact_loss_s", "upper": 0.01, **RULE}).cases
    assert case.contact_losses is None
    assert case.verdict == "skip"


@pytest.mark.parametrize(
    ("arc", "message"),
    [
        ({"pantograph": 3}, "found the pantographs"),
        ({"nominal_current_A": None}, "nominal_current_A is missing"),
        ({"detector": "IR"}, "key arc.detector: there is no column 'IR'"),
        ({"current": {"column": "I", "unit": "V"}}, "'V' is not a unit of this channel"),
    ],
)
def test_wrong_arc_tables_are_refused(sidecar: Path, arc: dict[str, Any], message: str) -> None:
    edit_toml(sidecar, {"arc": [{key: value for key, value in (ARC | arc).items() if value is not None}]})
    with pytest.raises(InputError, match=message):
        load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable())
