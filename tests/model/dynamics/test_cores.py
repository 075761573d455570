"""Core in C against the kernels of numba, its oracle: structures, results, bits, and the choice between both."""

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.core_library import COMPILER, compile_core
from helpers.lines import DAMPED, PANTOGRAPH_2002, Array, fix_along_track, overlapping_line, simple_line
from helpers.step_differences import THREE_MASSES
from helpers.structured_heads import structured, zigzag_line
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.runs.core_requirement import require_core
from pantocheck.model import Kind, ModalBand, Passage, discretise
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics import block_tridiagonal, connector_step, core_choice, newmark, panels, recording
from pantocheck.model.dynamics.active_window import build_window_arrays
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, Core, UnusableCore, call_core, choose_core, load_core
from pantocheck.model.dynamics.core_source import SOURCES
from pantocheck.model.dynamics.kernel_arrays import Load, build_kernel_arrays
from pantocheck.model.dynamics.motion import Motion, motion_at_rest
from pantocheck.model.dynamics.recording import allocate_recording, simulate_steps
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import Train, build_empty_train
from pantocheck.model.statics.static_solver import Deflection

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="a C compiler is needed")
ENTRIES = {
    "Step": newmark.step,
    "Advance": recording._advance,
    "Eliminate": block_tridiagonal._eliminate,
    "SolveStations": block_tridiagonal.solve_stations,
    "InverseColumns": connector_step.inverse_columns,
    "LargestTail": connector_step._largest_tail,
    "MeasureFade": panels.measure_fade,
}
"""Functions that Python calls in the core, by the structures of their arguments."""

State = dict[str, Array]


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Core:
    """Core in C of the checkout."""
    loaded = load_core(compile_core(tmp_path_factory.mktemp("core")))
    assert isinstance(loaded, Core), loaded
    return loaded


@pytest.fixture
def use_core(monkeypatch: pytest.MonkeyPatch) -> Callable[[Core | str], None]:
    """Function that replaces the core in C of the installation, or the reason why there is none."""
    monkeypatch.delenv(CORE_VARIABLE, raising=False)
    return lambda found: monkeypatch.setattr(core_choice, "find_core_in_c", lambda: found)


def simulate(line: DiscretisedLine, passage: Passage | None, drop: float = 0.0, steps: int = 300) -> State:
    """Recording and final state of a simulation; heads start with a speed downwards [m/s]; None: a released load."""
    line = replace(line)  # nothing that another core has built is shared
    names = [wire.name for wire in line.catenary.wires]
    row = line.mesh.row_of[line.catenary.contact_wires[0].name, "z"]
    if passage is None:
        kernel = build_kernel_arrays(line, 1e-3, load=Load(row, 20))
        train, load = build_empty_train(1), np.where(np.arange(steps) < 50, -300.0, 0.0)
        motion, _ = start_motion(line, kernel, Passage((PANTOGRAPH_2002,), (30.0,), 50.0, 1.0, 1e-3, ramp=1.0))
    else:
        kernel = build_kernel_arrays(line, passage.time_step, build_window_arrays(line, passage))
        (motion, train), load = start_motion(line, kernel, passage), np.zeros(steps)
        for p, pantograph in enumerate(passage.pantographs):
            train.z[1, p, : pantograph.head.size] = -drop * pantograph.head
    ahead = int(np.searchsorted(line.mesh.position, 8.0 + (passage.start[0] if passage else 30.0)))
    watched = tuple((name, float(line.mesh.position[ahead + n])) for n, name in enumerate(names[:2]))
    recorded = allocate_recording(line, watched, steps, train.owner.size)
    simulate_steps(kernel, motion, train, load, recorded)
    parts = {"contact": recorded.contact, "height": recorded.height, "slack": recorded.slack.astype(float)}
    parts |= {f"recorded {i}": recorded.motion[..., i] for i in range(3)}
    for name, field in (("w", motion.w), ("r", motion.r), ("z", train.z)):
        parts |= {f"{name} {i}": field[i] for i in range(3)}
    return parts | {"force": motion.force, "joint": train.joint_force, "final contact": train.contact}


def build_simulations() -> Iterator[tuple[str, Callable[[], State]]]:
    """Simulations with every part of the time step, by name."""
    pair = (PANTOGRAPH_2002, THREE_MASSES)
    plain = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    bumps = Irregularity(tuple(np.arange(0.0, 120.0, 1.5)), tuple(1e-3 * np.sin(np.arange(80.0))))
    rough = replace(plain, wires=(replace(plain.wires[0], irregularity=bumps), plain.wires[1]))
    modal = replace(plain, modal_damping=(ModalBand(0.8, 1.5, 0.02),))
    fast = Passage(pair, (24.0, 12.0), 80.0, 0.6, 2e-3)
    long = simple_line(spans=8, damping=dict.fromkeys(Kind, DAMPED[Kind.DROPPER]))
    laws: dict[str, dict[str, Any]] = {
        "spring": {}, "damper": {"contact_damping": 60.0}, "constraint": {"contact_stiffness": np.inf},
        "Hertz": {"contact_stiffness": np.inf, "hertz_coefficient": 1.2e7},
    }  # fmt: skip
    for name, law in laws.items():
        heads = tuple(replace(structured(base), **law) for base in pair)
        yield f"strips, {name}", lambda heads=heads: simulate(zigzag_line(), replace(fast, pantographs=heads), 1.0)
        bare = tuple(replace(base, **law) for base in pair)
        way = replace(fast, pantographs=bare, ramp=0.1)
        yield f"irregularity, {name}", lambda way=way: simulate(discretise(rough, 2.5), way, 1.5)
    yield "held stretches", lambda: simulate(discretise(fix_along_track(plain), 2.5), fast, 1.0)
    growing = replace(fast, kept_behind=0.0)
    yield "held stretches, window", lambda: simulate(discretise(fix_along_track(long), 1.0), growing, 1.0)
    yield "modal damping", lambda: simulate(discretise(modal, 2.5), fast, 1.0)
    window = Passage(pair, (120.0, 100.0), 60.0, 0.6, 2e-3, kept_behind=30.0, reach=60.0)
    yield "window", lambda: simulate(discretise(long, 1.0), window, 1.0)
    across = Passage(pair, (220.0, 200.0), 60.0, 0.6, 2e-3, kept_behind=30.0, reach=60.0)  # both ends cross a panel
    yield "several panels", lambda: simulate(discretise(long, 0.4), across, 1.0)
    overlap = Passage(pair, (80.0, 66.0), 80.0, 0.6, 2e-3)
    yield "overlap", lambda: simulate(discretise(overlapping_line(), 2.0), overlap, 1.0)
    yield "mass drop", lambda: simulate(discretise(plain, 2.0), None)


SIMULATIONS = dict(build_simulations())


def list_structures() -> dict[str, list[tuple[str, str]]]:
    """Fields of the structures of the C file, with their types."""
    text = SOURCES[0].read_text(encoding="utf-8")
    found = re.findall(r"typedef struct \{([^}]*)\} (\w+);", text)
    return {
        name: [(field, kind) for kind, fields in re.findall(r"(\w+) ([\w, ]+);", body) for field in fields.split(", ")]
        for body, name in found
    }


def kind_in_c(kind: Any) -> str:
    """Type of a field in C for its annotation in Python."""
    names = {float: "double", int: "int64_t", bool: "int64_t", Array: "Array"}
    shown = {"numpy.ndarray[tuple[typing.Any, ...], numpy.dtype[numpy.bool]]": "Flags"}
    return names.get(kind) or shown.get(str(kind)) or ("Indices" if "int" in str(kind) else kind.__name__)


def test_structures_are_the_named_tuples_of_python() -> None:
    """In their order, with their types: the core reads arguments word by word."""
    structures, checked = list_structures(), set()

    def check(kind: Any) -> None:
        expected = [(name, kind_in_c(part)) for name, part in kind.__annotations__.items()]
        assert structures[kind.__name__] == expected, kind.__name__
        checked.add(kind.__name__)
        for part in kind.__annotations__.values():
            if hasattr(part, "_fields"):
                check(part)

    for name, function in ENTRIES.items():
        expected = [("bytes", "int64_t")]
        for parameter in signature(function).parameters.values():
            expected.append((parameter.name, kind_in_c(parameter.annotation)))
            if hasattr(parameter.annotation, "_fields"):
                check(parameter.annotation)
        assert structures[f"{name}Arguments"] == expected, name
    assert {"KernelArrays", "ContactWorkspace", "Train", "Motion", "Recording"} <= checked


@pytest.mark.thorough
@needs_compiler
def test_both_cores_compute_the_same(
    core: Core, use_core: Callable[[Core | str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """To 1e-9 of the largest value: both stop their sweeps at changes of 1e-9 N of about 100 N, and round differently.

    Heads start downwards: contact is lost and regained, droppers slacken, joints slide and hit their stops. One test
    has all simulations, so that one process compiles the kernels, which takes 20 s; the tests of the reference kernel
    compare the core of the installation with full matrices in every run.
    """
    use_core(core)
    computed = {name: simulation() for name, simulation in SIMULATIONS.items()}
    monkeypatch.setenv(CORE_VARIABLE, "numba")
    different = []
    for name, simulation in SIMULATIONS.items():
        expected = simulation()
        for quantity, values in expected.items():
            scale = max(float(np.abs(values).max(initial=0.0)), 1e-6)
            if not float(np.abs(computed[name][quantity] - values).max(initial=0.0)) <= 1e-9 * scale:
                different.append((name, quantity))
        if name != "mass drop":
            lost = expected["contact"] == 0.0
            assert lost.any(), name
            assert not lost.all(axis=0).any(), name
    assert different == []


@needs_compiler
@pytest.mark.parametrize(
    "options",
    [
        ("-DWIDEST=2", "-O1"),
        pytest.param(("-march=native", "-funroll-loops"), marks=pytest.mark.thorough),
    ],
)
def test_bits_do_not_depend_on_vector_instructions_or_optimisation(
    options: tuple[str, ...], core: Core, use_core: Callable[[Core | str], None], tmp_path: Path
) -> None:
    """No product is fused with a sum, and sums over lanes have a fixed order."""
    other = load_core(compile_core(tmp_path, *options))
    found = []
    for one in (core, other):
        use_core(one)
        found.append([values.tobytes() for values in SIMULATIONS["strips, damper"]().values()])
    assert found[0] == found[1]


@needs_compiler
def test_threads_do_not_touch_each_other(core: Core, use_core: Callable[[Core | str], None]) -> None:
    """Two simulations of different lines at once, and one after the other: the same bits."""
    use_core(core)
    work = [SIMULATIONS["window"], SIMULATIONS["held stretches"]]
    with ThreadPoolExecutor(2) as pool:
        together = [future.result() for future in [pool.submit(simulation) for simulation in work]]
    for simulation, state in zip(work, together, strict=True):
        for quantity, values in simulation().items():
            np.testing.assert_array_equal(values, state[quantity])


@needs_compiler
@pytest.mark.parametrize("unilateral", [False, True])
def test_connector_that_can_push_is_not_slack_without_force(
    unilateral: bool, core: Core, use_core: Callable[[Core | str], None]
) -> None:
    """All connectors of a line that nothing moves carry 0 N without preload; those that cannot push are slack."""
    use_core(core)
    line = discretise(simple_line(), 2.5)
    zeros = np.zeros_like(line.connectors.preload)
    law = line.connectors._replace(preload=zeros, unilateral=np.full(zeros.size, unilateral))
    line = replace(line, connectors=law)
    kernel, recorded = build_kernel_arrays(line, 1e-3), allocate_recording(line, (), 1, 0)
    rest = Deflection(np.zeros_like(line.state.deflection), zeros)
    simulate_steps(kernel, motion_at_rest(kernel.layout, rest), build_empty_train(1), np.zeros(1), recorded)
    assert recorded.slack.tolist() == [zeros.size if unilateral else 0]


@needs_compiler
def test_state_is_that_of_motion_and_train(core: Core, use_core: Callable[[Core | str], None]) -> None:
    """Who writes their arrays back continues from the saved state, bit by bit: there is no other memory."""
    use_core(core)
    line = zigzag_line()
    passage = Passage((structured(PANTOGRAPH_2002),), (24.0,), 80.0, 0.6, 2e-3)
    kernel = build_kernel_arrays(line, passage.time_step)
    state: tuple[Motion, Train] = start_motion(line, kernel, passage)

    def advance() -> Array:
        recorded = allocate_recording(line, (), 100, 2)
        simulate_steps(kernel, *state, np.zeros(100), recorded)
        return recorded.contact

    advance()
    saved = [[values.copy() for values in part] for part in state]
    first = advance()
    for part, copies in zip(state, saved, strict=True):
        for values, copy in zip(part, copies, strict=True):
            values[...] = copy
    np.testing.assert_array_equal(advance(), first)


@needs_compiler
def test_library_of_another_source_is_not_used(tmp_path: Path, use_core: Callable[[Core | str], None]) -> None:
    reason = load_core(compile_core(tmp_path, "-O0", digest="0" * 64))
    assert isinstance(reason, str)
    assert "another source" in reason
    use_core(reason)
    assert choose_core().library is None
    (tmp_path / "broken.so").write_bytes(b"no library")
    assert "cannot be loaded" in str(load_core(tmp_path / "broken.so"))


def test_demanded_core_runs_or_the_run_is_refused(
    use_core: Callable[[Core | str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another core must not run silently in its place."""
    use_core("it was not compiled")
    assert choose_core().name.startswith("numba ")
    monkeypatch.setenv(CORE_VARIABLE, "c")
    with pytest.raises(InputError, match="demands the core in C, but it was not compiled"):
        require_core("reference simulator")
    monkeypatch.setenv(CORE_VARIABLE, "fortran")
    with pytest.raises(UnusableCore, match="must be 'c', 'numba' or 'reference'"):
        choose_core()
    monkeypatch.delenv(CORE_VARIABLE)
    monkeypatch.setattr(core_choice, "find_spec", lambda name: None)
    assert core_choice.core_name() == "none"
    with pytest.raises(InputError, match=r"pip install 'pantocheck\[simulator\]'"):
        require_core("reference simulator")


@needs_compiler
def test_arguments_of_another_form_are_refused(core: Core) -> None:
    """A wrong word would be an address somewhere."""
    assert core.library is not None
    with pytest.raises(UnusableCore, match="other structures"):
        call_core(core.library, "step", (1.0, 2))
    for values in (np.zeros((4, 4))[:, ::2], np.zeros(4, dtype=np.float32)):
        with pytest.raises(TypeError, match="contiguous, of 64-bit numbers"):
            call_core(core.library, "step", (values,))


@needs_compiler
def test_simulation_in_c_does_not_load_numba(core: Core) -> None:
    assert core.library is not None
    code = (
        "import sys; from pathlib import Path; from pantocheck.model.dynamics import core_choice\n"
        "core_choice.find_core_in_c = lambda: core_choice.load_core(Path(sys.argv[1]))\n"
        "from helpers.lines import PANTOGRAPH_2002, simple_line\n"
        "from pantocheck.model import Passage, discretise, simulate_passage\n"
        "simulate_passage(discretise(simple_line(), 1.0), Passage((PANTOGRAPH_2002,), (70.0,), 50.0, 0.1, 1e-3))\n"
        "print('numba' in sys.modules)"
    )
    command = [sys.executable, "-c", code, core.library._name]
    done = subprocess.run(
        command, cwd=Path(__file__).parents[2], env={"PYTHONPATH": "."}, capture_output=True, text=True, check=False
    )
    assert done.stdout == "False\n", done.stderr
