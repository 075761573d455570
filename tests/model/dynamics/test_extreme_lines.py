"""Extreme but valid lines and start transients: a correct record is never contradicted, a shifted one not verified.

The AC simple line of EN 50318:2018 is cut to ten spans and changed in one respect each. The mesh is coarse, 1 m and
2 ms: the checks need no converged solution, only one that obeys its equations of motion.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from helpers.extreme_runs import build_case, simulate
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.record_checks import check_record, judge_record_state, list_check_rows
from pantocheck.model import History, Passage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.recording import allocate_recording, simulate_steps
from pantocheck.model.dynamics.simulation import start_motion

WAVE_SPEED_KM_H = 3.6 * np.sqrt(22e3 / 1.35)
"""Wave speed of the contact wire of the AC simple line, 459.6 km/h."""

UNDAMPED = {"mass_coefficient_1_s": 0.0, "stiffness_coefficient_s": 0.0}

LINES: dict[str, dict[str, Any]] = {
    "one dropper per span": {"droppers": {"x_m": (27.5,), "presag_m": (0.0,), "length_m": None}},
    "105 % of the wave speed": {"speed": 1.05 * WAVE_SPEED_KM_H},
    "95 % of the wave speed": {"speed": 0.95 * WAVE_SPEED_KM_H},
    "bouncing": {"speed": 320.0, "force": 60.0},
    "soft contact": {"contact": {"stiffness_N_m": 5e3}},
    "hard contact": {"contact": {"stiffness_N_m": 1e6}},
    "spans of 80 m": {
        "geometry": {"span_m": 80.0},
        "droppers": {
            "x_m": tuple(np.linspace(5.0, 75.0, 11)),
            "presag_m": tuple(0.08 * (1 - np.linspace(-1.0, 1.0, 11) ** 2)),
            "length_m": None,
        },
    },
    "spans of 30 m": {
        "geometry": {"span_m": 30.0, "spans": 16},
        "spans": (9, 12),
        "droppers": {"x_m": (4.5, 11.5, 18.5, 25.5), "presag_m": (0.0, 0.02, 0.02, 0.0), "length_m": None},
    },
    "no damping": {"speed": 320.0, "damping": dict.fromkeys(("contact_wire", "messenger_wire", "droppers"), UNDAMPED)},
    "stagger of 0.6 m": {"geometry": {"stagger_contact_wire_m": 0.6}},
    "two contact wires": {"wire": {"number": 2, "spacing_m": 0.04}},
    "stiff pantograph": {"chain": {"stiffness_N_m": (1500.0, 60000.0, 40000.0)}},
    "three pantographs": {"pantographs": 3, "spacing": 60.0},
}

UNCONFIRMED = {"105 % of the wave speed"}
"""Lines whose trailing pantograph does not touch the wire at the supports: nothing there confirms its position."""


@pytest.fixture(scope="session")
def records() -> dict[str, tuple[Case, Record]]:
    cases = {name: build_case(**changes) for name, changes in LINES.items()}
    return {name: (case, simulate(case)) for name, case in cases.items()}


def state(case: Case, record: Record) -> tuple[str, str]:
    return judge_record_state(list_check_rows(check_record(case, RecordSignals(record, case.file.filter))))


def shift(record: Record, number: int, distance: float) -> Record:
    """The record with the positions of one pantograph shifted [m]."""
    position = record.position.copy()
    position[number - 1] += distance
    return replace(record, position=position)


def low_pass_all(record: Record) -> Record:
    """The record as a measuring chain of 20 Hz delivers it."""
    low_pass = Filter(cutoff_Hz=20.0)

    def smooth(channels: NDArray[np.float64] | None) -> NDArray[np.float64]:
        assert channels is not None
        return np.array([low_pass(channel, record.rate) for channel in channels])

    return replace(
        record,
        force=smooth(record.force),
        contact_height=smooth(record.contact_height),
        support_uplift=smooth(record.support_uplift),
        filter_applied_Hz=20.0,
    )


@pytest.mark.parametrize("name", LINES)
def test_correct_record_of_an_extreme_line_is_not_contradicted(
    records: dict[str, tuple[Case, Record]], name: str
) -> None:
    case, record = records[name]
    assert state(case, record)[0] == ("unconfirmed" if name in UNCONFIRMED else "consistent")


@pytest.mark.parametrize("name", LINES)
def test_filtered_or_rounded_record_of_an_extreme_line_is_not_contradicted(
    records: dict[str, tuple[Case, Record]], name: str
) -> None:
    """A chain of 20 Hz in all channels; height and uplift in whole millimetres."""
    case, record = records[name]
    assert record.support_uplift is not None
    rounded = replace(
        record, contact_height=np.round(record.contact_height, 3), support_uplift=np.round(record.support_uplift, 3)
    )
    for variant in (low_pass_all(record), rounded):
        assert state(case, variant)[0] != "contradicted"


@pytest.mark.parametrize("distance", [10.0, -10.0])
@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("name", LINES)
def test_shifted_position_of_either_pantograph_is_not_verified(
    records: dict[str, tuple[Case, Record]], name: str, number: int, distance: float
) -> None:
    case, record = records[name]
    assert state(case, shift(record, number, distance))[0] != "consistent"


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize(
    "name", ["soft contact", "two contact wires", "no damping", "stagger of 0.6 m", "stiff pantograph"]
)
def test_shifted_position_of_either_pantograph_is_contradicted(
    records: dict[str, tuple[Case, Record]], name: str, number: int
) -> None:
    """Where contact is hardly lost, no other bend of the wire resembles the kink."""
    case, record = records[name]
    found, reason = state(case, shift(record, number, 10.0))
    assert found == "contradicted"
    assert reason.startswith(
        f"the position of pantograph {number} contradicts the uplift: the wire bends at a support when "
    )


def ramp(seconds: float) -> Callable[[DiscretisedLine, Passage], History]:
    """Start with a tenth of the uplift force, raised to the full force by a half cosine, as other simulators do."""

    def run(line: DiscretisedLine, passage: Passage) -> History:
        gentle = tuple(
            replace(
                pantograph,
                force=pantograph.force - 0.9 * uplift(pantograph),
                static_force=0.1 * pantograph.static_force,
            )
            for pantograph in passage.pantographs
        )
        kernel = build_kernel_arrays(line, passage.time_step)
        motion, train = start_motion(line, kernel, replace(passage, pantographs=gentle))
        steps, block, histories = round(passage.duration / passage.time_step), 10, []
        for first in range(0, steps, block):
            share = min(first * passage.time_step / seconds, 1.0)
            raised = 0.9 * (1 - np.cos(np.pi * share)) / 2
            for row, (start, full) in enumerate(zip(gentle, passage.pantographs, strict=True)):
                train.force[row] = start.force + raised * uplift(full)
            part = allocate_recording(line, passage.watched, min(block, steps - first), len(gentle))
            simulate_steps(kernel, motion, train, np.zeros(part.slack.size), part)
            histories.append(part)
        time = passage.time_step * np.arange(1, steps + 1)
        return History(
            time,
            np.array(passage.start)[:, None] + passage.speed * time,
            np.concatenate([part.contact for part in histories]).T.copy(),
            np.concatenate([part.height for part in histories]).T.copy(),
            np.concatenate([part.motion for part in histories]).transpose(1, 0, 2).copy(),
            np.concatenate([part.contact for part in histories]).T.copy(),
        )

    def uplift(pantograph: Any) -> NDArray[np.float64]:
        """Uplift force, on the lowest mass."""
        return np.asarray(pantograph.static_force * np.eye(pantograph.head.size)[0])

    return run


@pytest.mark.parametrize(("seconds", "start"), [(1.0, 55.0), (3.0, 55.0), (2.0, 20.0)])
def test_record_of_another_start_is_verified(seconds: float, start: float) -> None:
    """Ramps of 1 to 3 s from another position; the longest ends before the analysis section begins."""
    case = build_case(speed=200.0, spans=(7, 8))
    case = replace(case, file=case.file.model_copy(update={"start_m": start}))
    record = simulate(case, ramp(seconds))
    assert record.force[:, 0].max() < 40.0, "the ramp starts near a tenth of 150 N"
    assert state(case, record) == ("consistent", "every consistency check that applies confirms the record")
