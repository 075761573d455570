"""Passages in lanes against the same passages alone, bit by bit, and against the reference kernel."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.core_library import COMPILER, compile_core
from helpers.lines import DAMPED, PANTOGRAPH_2002, Array, fix_along_track, overlapping_line, simple_line
from helpers.step_differences import THREE_MASSES
from helpers.structured_heads import structured, zigzag_line
from pantocheck.model import Kind, ModalBand, Passage, discretise, simulate_passage
from pantocheck.model.description.failures import DidNotConverge, ImpossiblePassage
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics import core_choice, lanes
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, Core, load_core
from pantocheck.model.dynamics.lanes import count_lanes, simulate_passages, split_into_lanes
from pantocheck.model.dynamics.passage import History
from pantocheck.model.dynamics.recording import Recording

pytestmark = pytest.mark.skipif(COMPILER is None, reason="a C compiler is needed")
PAIR = (PANTOGRAPH_2002, THREE_MASSES)
PLAIN = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
LONG = simple_line(spans=8, damping=dict.fromkeys(Kind, DAMPED[Kind.DROPPER]))
BUMPS = Irregularity(tuple(np.arange(0.0, 480.0, 1.5)), tuple(4e-3 * np.sin(np.arange(320.0))))
ROUGH = replace(LONG, wires=(replace(LONG.wires[0], irregularity=BUMPS), *LONG.wires[1:]))
WINDOW = Passage(PAIR, (120.03, 100.03), 80.0, 0.4, 1e-3, (("contact", 120.0), ("messenger", 180.0)), kept_behind=30.0)


def change(passage: Passage, shift: float, **changes: object) -> Passage:
    """Passage whose start is shifted [m], and which ends at the same place."""
    start = tuple(x + shift for x in passage.start)
    steps = round((passage.duration - shift / passage.speed) / passage.time_step)
    return replace(passage, start=start, duration=steps * passage.time_step, **changes)  # type: ignore[arg-type]


def with_law(**law: float) -> tuple:  # type: ignore[type-arg]
    """Pair of pantographs with another contact law."""
    return tuple(replace(base, **law) for base in PAIR)  # type: ignore[arg-type]


def list_groups() -> Iterator[tuple[str, DiscretisedLine, list[Passage]]]:
    """Lines with eight passages each, which differ in start, ramp, speed, pantographs and contact law."""
    weak = tuple(replace(base, force=0.4 * base.force) for base in PAIR)
    varied = [
        WINDOW,
        change(WINDOW, 16.0),
        change(WINDOW, -8.0),
        replace(WINDOW, ramp=0.1),
        replace(WINDOW, speed=70.0),
        replace(WINDOW, pantographs=weak),
        replace(WINDOW, pantographs=with_law(contact_damping=60.0)),
        replace(WINDOW, pantographs=with_law(contact_stiffness=np.inf, hertz_coefficient=1.2e7)),
    ]
    yield "windows", discretise(ROUGH, 1.0), varied
    # Windows of several panels; in moving stations, some end at 295 m with the second panel, before others.
    across = replace(WINDOW, speed=60.0, reach=30.0, watched=(("contact", 295.0), ("messenger", 295.0)))
    starts = [(238.0 + 3.0 * k, 218.0 + 3.0 * k) for k in range(8)]
    yield "panels", discretise(ROUGH, 0.4), [replace(across, start=start) for start in starts]
    heads = replace(WINDOW, pantographs=tuple(map(structured, PAIR)), start=(30.0, 18.0), watched=(), ramp=0.1)
    yield "strips and stagger", zigzag_line(), [change(heads, 2.0 * k) for k in range(8)]
    above = replace(WINDOW, start=(80.0, 66.0), watched=(), kept_behind=np.inf)
    dense = simple_line(droppers=tuple(np.arange(1.0, 60.0)))  # such droppers settle slowly: some lanes before others
    yield "overlap", discretise(overlapping_line(section=dense), 2.0), [change(above, 2.0 * k) for k in range(8)]


GROUPS = {name: (line, passages) for name, line, passages in list_groups()}


@pytest.fixture(scope="module", params=[8, 4, 2])
def core(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Core:
    """Core with vectors of some numbers at most; a processor without them takes shorter ones."""
    # Less optimisation halves the time of the compiler; `test_cores.py` shows that no bit depends on it.
    loaded = load_core(compile_core(tmp_path_factory.mktemp("core"), f"-DWIDEST={request.param}", "-O1"))
    assert isinstance(loaded, Core), loaded
    return loaded


@pytest.fixture
def slackness(core: Core, monkeypatch: pytest.MonkeyPatch) -> list[Array]:
    """Numbers of slack droppers over the steps of each passage in a lane; the core runs in C."""
    monkeypatch.delenv(CORE_VARIABLE, raising=False)
    monkeypatch.setattr(core_choice, "find_core_in_c", lambda: core)
    found: list[Array] = []
    build = lanes.build_history

    def keep(passage: Passage, window: object, train: object, recording: Recording) -> History:
        found.append(recording.slack)
        return build(passage, window, train, recording)  # type: ignore[arg-type]

    monkeypatch.setattr(lanes, "build_history", keep)
    return found


def list_bytes(history: History) -> list[bytes]:
    """Bits of a history."""
    values = (history.time, history.position, history.force, history.height, history.motion, history.strip_force)
    return [value.tobytes() for value in values]


@pytest.mark.parametrize("name", GROUPS)
def test_lanes_change_no_bit(name: str, slackness: list[Array]) -> None:
    """Droppers slacken and are taut again, and some contact is lost: each lane has its own state of both."""
    line, passages = GROUPS[name]
    together = simulate_passages(line, passages)
    assert len(slackness) == 8
    for passage, history in zip(passages, together, strict=True):
        assert list_bytes(history) == list_bytes(simulate_passage(line, passage))
    if name != "overlap":
        assert min(len(set(slack.tolist())) for slack in slackness) > 1
    if name == "windows":
        assert [bool((history.force == 0).any()) for history in together].count(True) > 1
    assert len({history.force.tobytes() for history in together}) == 8


def test_passage_does_not_depend_on_the_other_lanes(slackness: list[Array]) -> None:
    """Other passages, another order, and empty lanes."""
    line, passages = GROUPS["windows"]
    alone = {id(passage): list_bytes(simulate_passage(line, passage)) for passage in passages}
    for group in (passages[:4], passages[::-1], passages[3:8], [passages[2]] * 4):
        for passage, history in zip(group, simulate_passages(line, group), strict=True):
            assert list_bytes(history) == alone[id(passage)]
    assert slackness


@pytest.mark.parametrize("core", [8], indirect=True, scope="module")
def test_lanes_give_the_forces_of_the_reference_kernel(slackness: list[Array], monkeypatch: pytest.MonkeyPatch) -> None:
    """To 1e-8 of the largest force, as for a passage alone: sweeps stop at 1e-9 N, which a rigid contact amplifies."""
    line, passages = discretise(PLAIN, 2.5), [
        Passage(PAIR, (24.03 + 4.0 * k, 12.03 + 4.0 * k), 80.0, 0.2 - 0.01 * k, 2e-3, ramp=0.05) for k in range(4)
    ]  # fmt: skip
    computed = simulate_passages(line, passages)
    assert len(slackness) == 4
    monkeypatch.setenv(CORE_VARIABLE, "reference")
    for passage, history in zip(passages, computed, strict=True):
        expected = simulate_passage(replace(line), passage).force
        assert np.abs(history.force - expected).max() <= 1e-8 * expected.max()


def test_lines_without_lanes_run_one_after_another(slackness: list[Array], monkeypatch: pytest.MonkeyPatch) -> None:
    """Distributed forces have no lanes, and neither has another core; a short group is faster alone."""
    passages = [Passage((PANTOGRAPH_2002,), (24.0 + k,), 80.0, 0.02, 2e-3) for k in range(8)]
    lines = [fix_along_track(PLAIN), replace(PLAIN, modal_damping=(ModalBand(0.8, 1.5, 0.02),)), PLAIN]
    held, modal, plain = (discretise(catenary, 2.5) for catenary in lines)
    assert [count_lanes(line) for line in (held, modal)] == [1, 1]
    assert count_lanes(plain) > 1
    shares = list[float]()
    for history, passage in zip(simulate_passages(modal, passages, shares.append), passages, strict=True):
        assert list_bytes(history) == list_bytes(simulate_passage(modal, passage))
    assert shares[-1] == 1.0
    assert sorted(shares) == shares
    assert not slackness
    assert sum(map(len, split_into_lanes(plain, passages))) == 8
    assert split_into_lanes(plain, []) == []
    assert split_into_lanes(plain, [1, 2, 3][: count_lanes(plain) - 1])[0] == [1]
    monkeypatch.setattr(core_choice, "find_core_in_c", lambda: "it was not compiled")
    assert count_lanes(plain) == 1


def test_failure_in_a_lane_is_that_of_the_passage_alone(slackness: list[Array]) -> None:
    """The message states the time since the start of the passage that failed."""
    line = discretise(ROUGH, 1.0)
    broken = replace(WINDOW, pantographs=with_law(contact_stiffness=np.nan))
    passages = [*[change(WINDOW, 8.0 * k) for k in range(3)], change(broken, 16.0)]
    with pytest.raises(DidNotConverge) as alone:
        simulate_passage(line, passages[-1])
    with pytest.raises(DidNotConverge) as together:
        simulate_passages(line, passages)
    assert str(together.value) == str(alone.value)
    with pytest.raises(ImpossiblePassage, match="the line extends from"):
        simulate_passages(line, [*passages[:3], replace(WINDOW, duration=100.0)])


def test_library_refuses_other_structures(core: Core, tmp_path: Path) -> None:
    """The words of a lane have another size."""
    assert core.library is not None
    line, passages = GROUPS["windows"]
    kernel = lanes.build_kernel_arrays(line, passages[0].time_step)
    scalar = lanes.ScalarWorkspace(*(np.zeros((1, 2)) for _ in range(3)))
    with pytest.raises(core_choice.UnusableCore, match="other structures"):
        core_choice.call_core(
            core.library, "advance_lanes", (kernel, scalar, np.zeros((1, 2)), np.zeros((2, 3), np.int64), 0, 1)
        )
