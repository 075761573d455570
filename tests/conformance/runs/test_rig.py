"""A line against a rig in simulated time: motion of the line, correction, every limit, messages and refusals."""

import io
import json
import socket
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.short_cases import change_case
from pantocheck.conformance.app.commands import system_self_test_command
from pantocheck.conformance.app.self_test.adapter_check import build_short_case, build_twin_case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.runs import rig_control
from pantocheck.conformance.runs.record_folder import read_case_record
from pantocheck.conformance.runs.rig_control import LowPass, RigControl, RigLimits, RigRow
from pantocheck.conformance.runs.rig_link import (
    RigCommand,
    RigPhase,
    RigSample,
    pack_command,
    pack_sample,
    read_command,
    read_sample,
)
from pantocheck.conformance.runs.rig_loop import RigLog, TimeHistogram, run_loop
from pantocheck.conformance.runs.rig_run import build_stepped_passage, check_limits
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.dynamics.core_choice import choose_core
from pantocheck.model.dynamics.moved_head import MovedHead
from pantocheck.model.dynamics.simulation import simulate_passage
from pantocheck.model.dynamics.stepped_passage import SteppedPassage
from verification.rig.rig_accuracy import EDGES_HZ, compare_bands
from verification.rig.simulated_rig import DirectLink, RigFaults, SimulatedClock, SimulatedRig, change_head, serve

pytestmark = pytest.mark.skipif(choose_core().library is None, reason="a rig needs the core in C")

STEP_S = 1e-3
LIMITS = RigLimits(force=500.0, travel=0.3, speed=5.0, correction=200.0, watchdog=0.05, connection=1.0)


@pytest.fixture(scope="module")
def line() -> SteppedPassage:
    """Passage of the short case."""
    return build_stepped_passage(change_case(build_short_case(), mesh=(2.0, STEP_S)), STEP_S)


def run(
    line: SteppedPassage, limits: RigLimits = LIMITS, rig: SimulatedRig | None = None, link: DirectLink | None = None
) -> tuple[RigControl, np.ndarray]:
    """Run one passage in simulated time; control at its end, and rows of the log."""
    rig = rig or SimulatedRig(line.passage.pantographs[0], line.start_height, STEP_S)
    control, log = RigControl(line, limits, 50.0, 1), io.BytesIO()
    run_loop(control, link or DirectLink(rig), SimulatedClock(), RigLog(log))
    return control, np.frombuffer(log.getvalue()).reshape(-1, len(RigRow._fields))


def test_passage_in_steps_is_the_passage(line: SteppedPassage) -> None:
    """The same core with the same arrays: equal bits."""
    case = change_case(build_short_case(), mesh=(2.0, STEP_S))
    whole = simulate_passage(discretise_line(case.line, 2.0), line.passage)
    line.restart()
    states = [line.advance(0.0) for _ in range(line.steps)]
    np.testing.assert_array_equal([state.force for state in states], whole.force[0])
    np.testing.assert_array_equal(line.build_history().motion, whole.motion)
    line.restart()
    assert line.advance(0.0) == states[0]


def test_moved_head_gives_the_force_of_the_pantograph(line: SteppedPassage) -> None:
    """Central differences of the height, one sample late: of second order, (omega dt)^2 / 3 at the end of a band."""
    line.restart()
    states = [line.advance(0.0) for _ in range(line.steps)]
    head = MovedHead(line.passage.pantographs[0], line.start_height, STEP_S)
    late = np.array([head.follow(line.start_height + state.height) for state in states])
    found = compare_bands(late[1:], np.array([state.force for state in states])[:-1])
    assert np.all(found < (2 * np.pi * np.array(EDGES_HZ[1:]) * STEP_S) ** 2 / 3)


@pytest.mark.parametrize("delay_ms", [0, 10])
def test_exact_model_hides_a_delay(line: SteppedPassage, delay_ms: int) -> None:
    """1 % in every band of 5 Hz; the coupling itself would be unstable with a delay of 10 ms."""
    expected = np.array([line.advance(0.0).force for _ in range(line.steps)]) if line.restart() is None else None
    rig = SimulatedRig(line.passage.pantographs[0], line.start_height, STEP_S, -0.05, RigFaults(delay_ms / 1000))
    control, rows = run(line, rig=rig)
    assert (control.reason, control.left, control.phase) == ("", 0, RigPhase.END)
    assert compare_bands(line.build_history().force[0], expected).max() < 0.01
    assert np.nanmax(rows[:, RigRow._fields.index("delay")]) == pytest.approx(
        delay_ms / 1000 + 1.5 * STEP_S, abs=0.6 * STEP_S
    )


def test_correction_removes_most_of_a_wrong_mass(line: SteppedPassage) -> None:
    """A head 20 % heavier: up to 20 Hz, the corrected force is twice as near to the truth as that of the model."""
    heavier = change_head(line.passage.pantographs[0], mass=1.2)
    case = change_case(build_short_case(), mesh=(2.0, STEP_S))
    truth = simulate_passage(discretise_line(case.line, 2.0), replace(line.passage, pantographs=(heavier,))).force[0]
    line.restart()
    model = np.array([line.advance(0.0).force for _ in range(line.steps)])
    control, _ = run(line, rig=SimulatedRig(heavier, line.start_height, STEP_S))
    assert not control.reason
    corrected = compare_bands(line.build_history().force[0], truth)[:4]
    assert corrected.max() < compare_bands(model, truth)[:4].max() / 2


class SilentLink(DirectLink):
    """Link that loses all samples from a command on."""

    def __init__(self, rig: SimulatedRig, last: int) -> None:
        super().__init__(rig)
        self.last = last

    def receive(self) -> list[RigSample | None]:
        """Samples since the last call, up to the last one."""
        return [sample for sample in super().receive() if sample is not None and sample.number <= self.last]


class RaisedLink(DirectLink):
    """Link of a rig whose head is 400 mm higher than commanded after 3.6 s."""

    def receive(self) -> list[RigSample | None]:
        """Samples since the last call."""
        return [
            sample and sample._replace(height=sample.height + 0.4 * (sample.number > 3600))
            for sample in super().receive()
        ]


class LateClock(SimulatedClock):
    """Clock that is late once."""

    def wait(self, until: float) -> None:
        """Move on to a time, and once 60 ms further."""
        super().wait(until + 0.06 * (4.0 <= until < 4.0 + STEP_S / 2))


LIMITED: dict[str, tuple[dict[str, float], str]] = {
    "force": ({"force": 130.0}, "the measured force is 13"),
    "travel": ({"travel": 0.005}, "the height of the line is"),
    "speed": ({"speed": 0.02}, "the head of the line moves with"),
    "watchdog": ({"watchdog": 0.0005}, "the rig obeys a command of 2 ms ago"),
}


@pytest.mark.parametrize("name", LIMITED)
def test_a_limit_that_is_exceeded_brakes_the_head(name: str, line: SteppedPassage) -> None:
    """At most the travel, and a hundredth of the speed of the passage after 0.5 s of braking."""
    change, reason = LIMITED[name]
    control, rows = run(line, LIMITS._replace(**change))
    assert control.reason.startswith(reason), control.reason
    assert control.left == 1
    height, velocity = rows[:, 2], rows[:, 3]
    assert np.abs(height).max() <= control.limits.travel
    assert rows[-1, 1] == RigPhase.STOP
    assert abs(velocity[-1]) < 1e-4
    assert np.isfinite(rows[:, :5]).all()


def test_a_rig_that_is_silent_late_faulty_or_another_one_is_stopped(line: SteppedPassage) -> None:
    own = line.passage.pantographs[0]
    rig = SimulatedRig(own, line.start_height, STEP_S)
    assert run(line, link=SilentLink(rig, 3600))[0].reason.startswith("no sample for 51 ms, in phase passage")
    assert run(line, link=SilentLink(rig, 0))[0].reason.startswith("no sample within 1 s")
    control = RigControl(line, LIMITS, 50.0, 1)
    link = DirectLink(SimulatedRig(own, line.start_height, STEP_S))
    times = run_loop(control, link, LateClock(), RigLog(io.BytesIO()))
    assert control.reason.startswith("a step began 60 ms late")
    assert times.missed == pytest.approx(59, abs=1)  # until the ticks have caught up
    rig = SimulatedRig(own, line.start_height, STEP_S)
    rig.fault = 7
    assert run(line, rig=rig)[0].reason.startswith("the rig reports the fault 7")
    pressed = replace(own, force=1.5 * own.force)
    control = run(line, rig=SimulatedRig(pressed, line.start_height, STEP_S))[0]
    assert "the mean force at rest is" in control.reason
    control = run(
        line, LIMITS._replace(correction=5.0), SimulatedRig(change_head(own, 2.0), line.start_height, STEP_S)
    )[0]
    assert "the pantograph of the rig is not that of the case" in control.reason
    rig = SimulatedRig(own, line.start_height, STEP_S)
    assert run(line, link=RaisedLink(rig))[0].reason.startswith("the measured height is 4")


def test_a_head_beyond_the_travel_is_approached(line: SteppedPassage) -> None:
    """The limit of the travel begins at the start of the passage."""
    rig = SimulatedRig(line.passage.pantographs[0], line.start_height, STEP_S, begin=-0.12)
    assert run(line, LIMITS._replace(travel=0.1), rig)[0].reason == ""


def test_an_interruption_brakes_the_head(line: SteppedPassage) -> None:
    control = RigControl(line, LIMITS, 50.0, 1)

    class Interrupted(DirectLink):
        def receive(self) -> list[RigSample | None]:
            if control.number == 3500:
                raise KeyboardInterrupt
            return super().receive()

    rig = SimulatedRig(line.passage.pantographs[0], line.start_height, STEP_S)
    with pytest.raises(KeyboardInterrupt):
        run_loop(control, Interrupted(rig), SimulatedClock(), RigLog(io.BytesIO()))
    assert (control.finished, control.phase) == (True, RigPhase.STOP)
    assert control.reason.startswith("the run was interrupted, in phase passage")


def test_messages_are_read_back_and_others_refused() -> None:
    command, sample = RigCommand(RigPhase.HOLD, 7, 0.1, -0.2), RigSample(0, 6, 1.5, 0.01, 120.0)
    assert read_command(pack_command(command)) == command
    assert read_sample(pack_sample(sample)) == sample
    message = pack_sample(sample)
    broken: Sequence[bytes] = (b"", message[:-1], message + b"0", b"PCR1" + message[4:], pack_command(command))
    assert [read_sample(each) for each in broken] == [None] * 5
    assert read_sample(pack_sample(sample._replace(force=float("nan")))) is None
    assert read_command(struct.pack("<4sIQdd", b"PCR1", 9, 1, 0.0, 0.0)) is None


def test_old_and_foreign_samples_are_counted_and_not_used(line: SteppedPassage) -> None:
    control = RigControl(line, LIMITS, 50.0, 1)
    control.advance([RigSample(0, 0, 1.0, 0.0, 120.0)], 0.0)
    control.advance([None, RigSample(0, 1, 0.9, 0.2, 999.0), RigSample(0, 99, 2.0, 0.2, 999.0)], 0.0)
    assert (control.samples, control.refused) == (1, 3)
    assert control.row().measured_force == 120.0


def test_low_pass_has_the_gain_of_its_cutoff() -> None:
    """1 / sqrt(2) at the cut-off of a Butterworth filter, 1 at rest; the settled sine is compared, to 1e-6."""
    low, time = LowPass(50.0, STEP_S), STEP_S * np.arange(2000)
    found = np.array([low.apply(1 + x) for x in np.sin(2 * np.pi * 50 * time)])[1000:]
    assert found.mean() == pytest.approx(1.0, abs=1e-6)
    assert np.ptp(found - found.mean()) / np.ptp(np.sin(2 * np.pi * 50 * time)) == pytest.approx(2**-0.5, rel=2e-2)
    assert np.std(found) == pytest.approx(0.5, rel=1e-6)


def test_quantiles_of_times_are_those_of_the_counts() -> None:
    times = TimeHistogram()
    for microseconds in (*[10] * 98, 500, 30_000):
        times.add(1e-6 * microseconds + 1e-9)
    assert (times.quantile_us(0.5), times.quantile_us(0.99)) == (11, 501)
    assert times.worst_s == pytest.approx(0.03)


def test_limits_below_the_passage_and_other_cases_are_refused(line: SteppedPassage) -> None:
    with pytest.raises(InputError, match=r"(?s)limit of the travel: is 1 mm.*passage of the linear model needs"):
        check_limits(line, LIMITS._replace(travel=0.001))
    with pytest.raises(InputError, match=r"limit of the speed: is 0\.001 m/s; "):
        check_limits(line, LIMITS._replace(speed=0.001))
    with pytest.raises(InputError, match="a passage in steps has one linear pantograph with one strip"):
        build_stepped_passage(build_twin_case(), STEP_S)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--rig", "nowhere"), "is not an address"),
        (("--rig", "127.0.0.1:99999"), "is not an address"),
        (("--rig", "127.0.0.1:5320", "--connection-s", "0.1"), "no sample within 0.1 s"),
        (("--rig", "127.0.0.1:5320", "--travel-limit-mm", "2"), "limit of the travel"),
    ],
)
def test_command_refuses_what_cannot_run(options: Sequence[str], reason: str, tmp_path: Path) -> None:
    changes = ("en50318-2002/250", *options, "--out", tmp_path / "rig")
    result = pantocheck("system", "rig", *changes)
    assert result.exit_code == 2, result.output
    assert reason in " ".join(result.output.split())


@pytest.mark.parametrize(("fault", "exit_code"), [pytest.param(0, 0, marks=pytest.mark.thorough), (7, 1)])
def test_command_runs_a_rig_over_udp(
    fault: int, exit_code: int, line: SteppedPassage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In real time, with a watchdog of 5 s: the machine of a test may be busy. The record is one of the case."""
    case = change_case(build_short_case(), mesh=(2.0, STEP_S))
    monkeypatch.setattr(system_self_test_command, "choose_train_case", lambda *_: case)
    monkeypatch.setattr(rig_control, "HOLD_S", 1.2)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    rig = SimulatedRig(line.passage.pantographs[0], line.start_height, STEP_S, begin=0.0)
    rig.fault = fault
    server = Thread(target=serve, args=(rig, port), daemon=True)
    server.start()
    limits = ("--watchdog-ms", 5000, "--speed-limit-m-s", 5, "--force-limit-N", 500)
    result = pantocheck("system", "rig", case.id, "--rig", f"127.0.0.1:{port}", *limits, "--out", tmp_path)
    server.join(timeout=10.0)
    assert (result.exit_code, server.is_alive()) == (exit_code, False), result.output
    summary = json.loads((tmp_path / "rig.json").read_text("utf-8"))
    assert len(np.load(tmp_path / "log.npy")) == summary["steps"]
    if exit_code:
        assert summary["stopped"].startswith("the rig reports the fault 7")
        assert not (tmp_path / "record.csv").exists()
    else:
        assert (summary["stopped"], summary["passages"]) == (None, 1)
        assert read_case_record(tmp_path / "record.csv", case)[0].force.shape[1] == line.steps


def test_a_head_with_two_strips_is_refused(line: SteppedPassage) -> None:
    own = line.passage.pantographs[0]
    two = replace(own, own_strips=own.strips * 2)
    with pytest.raises(ImpossiblePassage, match="one linear pantograph with one strip"):
        SteppedPassage(discretise_line(build_short_case().line, 2.0), replace(line.passage, pantographs=(two,)))
