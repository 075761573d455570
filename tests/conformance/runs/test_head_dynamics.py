"""Dynamics of records of heads with friction, stops, roll and bending: own records hold, wrong ones do not."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from helpers.short_cases import change_case, shorten_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.documents.row_check import list_repeated, repeat_check
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.pantograph.head_tables import HeadTable
from pantocheck.conformance.records.evaluated_signals import pack_signals, unpack_signals
from pantocheck.conformance.records.record import FORCE_CHANNELS, Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.check import Finding
from pantocheck.conformance.runs.force_dynamics import DYNAMICS, find_unknown_motion
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE
from pantocheck.model import build_chain
from pantocheck.model.description.driven_head import drive_head
from pantocheck.model.description.head_structure import add_friction, add_stop
from verification.formulations.finite_differences import find_case

STRIPS = [
    {"position_m": 0.29, "mass_kg": 3.0, "stiffness_N_m": 1e4, "damping_N_s_m": 20.0},
    {"position_m": -0.25, "mass_kg": 2.5, "stiffness_N_m": 1e4, "damping_N_s_m": 20.0},
]
ROTATION = {"inertia_kg_m2": 2.0, "stiffness_N_m_rad": 300.0, "damping_N_m_s_rad": 5.0}
FRICTION = {"friction": [{"between": [2, 3], "force_N": 12.0}, {"between": ["base", 1], "force_N": 12.0}]}
STOPS = {"stop": [{"between": [2, 3], "compression_m": 0.024, "stiffness_N_m": 1e5, "damping_N_s_m": 50.0}]}
HEADS: dict[str, dict[str, Any]] = {
    "two strips": {"strip": STRIPS},
    "friction": FRICTION,
    "stops": STOPS,
    "bending": {"bending_mode": [{"frequency_Hz": 31.0, "damping_ratio": 0.02, "shapes": [[0.3, 0.0, -0.8]]}]},
    "roll": {"strip": STRIPS, "roll": ROTATION},
    "all": {"strip": STRIPS, "roll": ROTATION, **FRICTION, **STOPS},
}


def with_head(case: Case, head: dict[str, Any] | None) -> Case:
    table = None if head is None else HeadTable.model_validate(head)
    return replace(case, pantographs=tuple(f.model_copy(update={"head": table}) for f in case.pantographs))


@cache
def run(name: str) -> tuple[Case, Record]:
    (case,) = (case for case in select_cases(["en50318-2018/ac-simple/320"]) if case.id.endswith("/320"))
    case = with_head(change_case(shorten_case(case, 250.0, 0.2, 1), mesh=(1.0, 2e-3)), HEADS[name])
    return case, run_passage(case, discretise_line(case.line, 1.0), case.file.discretisation).record


def find(case: Case, record: Record) -> tuple[Finding, Finding]:
    signals = RecordSignals(record, case.file.filter)
    return DYNAMICS.run(case, signals), IMPLIED_FORCE.run(case, signals)


def change_forces(record: Record, change: Any) -> Record:
    forces = {name: getattr(record, name) for name in FORCE_CHANNELS}
    return replace(record, **{name: change(force) for name, force in forces.items() if force is not None})


@pytest.mark.parametrize("name", HEADS)
def test_own_record_is_confirmed_and_a_late_one_is_not(name: str) -> None:
    """The wire's vibrations across the track leave 0.03 with roll, and doubt beside friction; 20 ms are 10 samples."""
    case, record = run(name)
    expected = ["confirmed", "doubt" if name == "all" else "confirmed"]
    assert [finding.kind for finding in find(case, record)] == expected
    assert find(case, record)[0].basis.kind == "measured"
    late = find(case, change_forces(record, lambda force: np.roll(force, 10, axis=1)))[0]
    assert late.kind == ("doubt" if name in ("bending", "roll", "all") else "contradiction")


@pytest.mark.parametrize("name", ["friction", "stops"])
def test_wrong_gain_contradicts_the_motion(name: str) -> None:
    case, record = run(name)
    assert find(case, change_forces(record, lambda force: 1.05 * force))[0].kind == "contradiction"


@pytest.mark.parametrize("name", ["friction", "stops", "roll"])
def test_record_of_another_head_is_noticed(name: str) -> None:
    """The record was made with the law, the case has none."""
    case, record = run(name)
    other = with_head(case, {"strip": STRIPS} if "strip" in HEADS[name] else None)
    assert "confirmed" not in {find(other, record)[0].kind, min(finding.kind for finding in find(other, record))}


def test_motion_that_a_record_does_not_determine_is_not_checked() -> None:
    case, record = run("two strips")
    without = replace(record, front_strip=None, rear_strip=None)
    assert "no forces of the strips" in find(case, without)[0].text
    base = {"strip": STRIPS, "stop": [{"between": ["base", 1], "extension_m": 0.3, "stiffness_N_m": 1e5}]}
    assert "above its base" in find(with_head(case, base), record)[0].text
    curved = with_head(find_case("en50318-2018/ac-simple/320+curved"), HEADS["roll"])
    reason = find_unknown_motion(curved, RecordSignals(record, case.file.filter), 1)
    assert reason == "the record does not state the place of the wire on pantograph 1"


def test_embedded_signals_do_not_repeat_checks_that_need_the_run_in() -> None:
    assert DYNAMICS in list_repeated(run("two strips")[0])
    names = {check.name for check in list_repeated(run("friction")[0])}
    assert not names & {DYNAMICS.name, IMPLIED_FORCE.name}


def test_embedded_strips_repeat_the_checks_of_the_record() -> None:
    """Filters begin at the embedded signals: 1e-4 of the threshold of 0.1, as the verification accepts."""
    case, record = run("two strips")
    signals = RecordSignals(record, case.file.filter)
    packed = pack_signals(signals.pantographs, signals.line, record.time)
    assert packed is not None
    repeated = repeat_check(DYNAMICS, case, unpack_signals(packed, case.file.filter)).basis
    assert repeated.number == pytest.approx(find(case, record)[0].basis.number, abs=1e-5)


def test_driven_mass_sticks_slides_and_stops() -> None:
    """A mass of 2 kg without a spring: 5 N below friction creep at 5/12 mm/s, 20 N slide with (20 - 12)/2 m/s2."""
    chain = build_chain(np.array([2.0]), np.array([0.0]), np.array([0.0]), 0.0, 0, np.inf)
    rubbed, time = add_friction(chain, np.ones(1), 12.0, 1e-3), np.arange(0, 0.5, 1e-3)
    place = np.zeros((1, time.size))
    creep = drive_head(rubbed, np.full((1, time.size), -5.0), place, 1e-3)
    assert (creep[-1] - creep[-101]) / 0.1 == pytest.approx(5 / 12 * 1e-3, rel=1e-6)
    slide = drive_head(rubbed, np.full((1, time.size), -20.0), place, 1e-3)
    # Friction begins within the first step: half of it is missing there, 3 mm/s of 2 m/s.
    assert slide[-1] == pytest.approx(4.0 * time[-1] ** 2 / 2 + 3e-3 * time[-1], rel=1e-4)
    held = drive_head(
        add_stop(chain, np.ones(1), 0.01, 1e5, 2000.0),
        np.full((1, 4 * time.size), -20.0),
        np.zeros((1, 4 * time.size)),
        1e-3,
    )
    assert held[-1] == pytest.approx(0.01 + 20.0 / 1e5, rel=1e-3)
