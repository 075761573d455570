"""Pantographs that another program moves: the record is that of the same pantograph inside the step."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, simple_line
from helpers.step_differences import THREE_MASSES
from pantocheck.model import Passage, simulate_passage
from pantocheck.model.description.arrays import Array
from pantocheck.model.description.failures import DidNotConverge, ImpossiblePassage
from pantocheck.model.description.head_structure import MountedStrip, Rotation, mount_strips
from pantocheck.model.description.pantograph import Pantograph, equilibrium
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.passage import History


@dataclass
class Program:
    """Linear pantograph in a program of its own, by the midpoint rule in substeps."""

    pantograph: Pantograph
    time_step: float
    substeps: int = 1
    can_repeat: bool = True
    sign: float = 1.0
    delay: int = 0
    start: float = 0.03
    state: tuple[Array, Array] = field(init=False)

    def __post_init__(self) -> None:
        model, h = self.pantograph, self.time_step / self.substeps
        self.inverse = np.linalg.inv(model.mass + h / 2 * model.damping + h**2 / 4 * model.stiffness)
        self.restart()

    def restart(self) -> None:
        rest = equilibrium(self.pantograph, self.start)[0]
        self.state = self.trial = (rest, np.zeros(rest.size))
        self.heights = [self.heads(rest)] * (self.delay + 1)

    def heads(self, z: Array) -> Array:
        return self.pantograph.strip_shapes @ z

    def attempt(self, force: Array) -> Array:
        model, h = self.pantograph, self.time_step / self.substeps
        z, v = self.state
        load = model.force - self.sign * model.strip_shapes.T @ force
        for _ in range(self.substeps):
            mean = self.inverse @ (model.mass @ v + h / 2 * (load - model.stiffness @ z))
            z, v = z + h * mean, 2 * mean - v
        self.trial = (z, v)
        return [*self.heights, self.heads(z)][-1 - self.delay]

    def accept(self) -> None:
        self.state = self.trial
        self.heights = [*self.heights[1:], self.heads(self.state[0])] if self.delay else self.heights


def short_line() -> DiscretisedLine:
    return discretise(simple_line(spans=4, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED), 1.0)


PASSAGE = Passage((PANTOGRAPH_2002, THREE_MASSES), (30.0, 12.0), 60.0, 0.8, 1e-3)
TWO_STRIPS = mount_strips(
    PANTOGRAPH_2002, (MountedStrip(0.3, 3.0, 5e3, 20.0), MountedStrip(-0.28, 3.0, 6e3, 15.0)), Rotation(0.8, 40.0, 3.0)
)


def largest_force_difference(first: History, second: History) -> float:
    """Largest difference over the standard deviation, after the first 0.1 s of the start [-]."""
    later = first.time > 0.1
    return float(np.abs(first.strip_force - second.strip_force)[:, later].max() / first.force[:, later].std())


@pytest.mark.parametrize("law", ["spring", "damper", "constraint", "ramp", "two strips"])
def test_a_program_with_rollback_gives_the_record_of_the_step(law: str) -> None:
    """The midpoint rule is average acceleration; heights agree to 1e-9 m, and the start is at rest to 2e-3 N.

    A constraint turns 1e-9 m into 5e-4 of the force by the residual flexibility of the wire.
    """
    laws = {"damper": {"contact_damping": 60.0}, "constraint": {"contact_stiffness": np.inf}}
    pair = (TWO_STRIPS, THREE_MASSES) if law == "two strips" else PASSAGE.pantographs
    pantographs = tuple(replace(pantograph, **laws.get(law, {})) for pantograph in pair)
    passage = replace(PASSAGE, pantographs=pantographs, ramp=0.3 if law == "ramp" else 0.0)
    line = short_line()
    expected = simulate_passage(line, passage)
    programs = [Program(pantograph, passage.time_step) for pantograph in pantographs]
    found = simulate_passage(line, passage, programs=programs)
    assert largest_force_difference(expected, found) < (1e-3 if law == "constraint" else 3e-4)
    assert np.abs(found.height - expected.height).max() < 1e-6
    for coupling in found.coupling:
        assert abs(coupling.energy) < 2e-6 * coupling.exchanged
        assert coupling.attempts < 3.2 * found.time.size


def test_the_error_of_an_explicit_coupling_falls_with_the_step() -> None:
    """Without rollback, heights are extrapolated: error and energy are of order 3 in the step, or better (8 a half)."""
    line = short_line()
    found = []
    for step in (4e-3, 2e-3):
        passage = replace(PASSAGE, pantographs=(TWO_STRIPS, THREE_MASSES), time_step=step)
        repeated, explicit = (
            simulate_passage(line, passage, programs=[Program(p, step, 1, can_repeat) for p in passage.pantographs])
            for can_repeat in (True, False)
        )
        difference = np.abs(repeated.force - explicit.force).max() / repeated.force.std()
        found.append((difference, max(abs(coupling.energy / coupling.exchanged) for coupling in explicit.coupling)))
    (coarse, coarse_energy), (fine, fine_energy) = found
    assert fine < 2e-3
    assert fine < coarse / 6
    assert fine_energy < min(coarse_energy / 6, 1e-3)


def test_a_program_with_finer_steps_differs_by_the_error_of_the_step() -> None:
    """The midpoint rule in ten substeps is nearly exact; the difference has order 2 in the step of the line."""
    line = short_line()
    differences = []
    for step in (2e-3, 1e-3):
        passage = replace(PASSAGE, time_step=step)
        programs = [Program(pantograph, step, 10) for pantograph in passage.pantographs]
        found = simulate_passage(line, passage, programs=programs)
        differences.append(largest_force_difference(simulate_passage(line, passage), found))
    assert differences[1] < 1e-3
    assert differences[0] / differences[1] == pytest.approx(4, rel=0.2)


def test_a_program_beside_a_model_moves_its_own_pantograph_only() -> None:
    passage = PASSAGE
    line = short_line()
    found = simulate_passage(line, passage, programs=[None, Program(THREE_MASSES, passage.time_step)])
    assert len(found.coupling) == 1
    assert largest_force_difference(simulate_passage(line, passage), found) < 1e-4


@pytest.mark.parametrize(
    ("change", "failure", "reason"),
    [
        ({"sign": -1.0}, ImpossiblePassage, "falls by -.*check the sign of its force"),
        ({"delay": 1}, ImpossiblePassage, "falls by 0 m.*answers within the step"),
        ({"pantograph": replace(PANTOGRAPH_2002, force=1.1 * PANTOGRAPH_2002.force)}, ImpossiblePassage, "held with"),
        (
            {"pantograph": replace(PANTOGRAPH_2002, damping=PANTOGRAPH_2002.damping - 400 * np.eye(2))},
            DidNotConverge,
            "does not come to rest",
        ),
    ],
)
def test_a_broken_program_is_refused_with_its_reason(
    change: dict[str, object], failure: type[Exception], reason: str
) -> None:
    passage = replace(PASSAGE, pantographs=(PANTOGRAPH_2002,), start=(30.0,))
    program = replace(Program(PANTOGRAPH_2002, passage.time_step), **change)
    with pytest.raises(failure, match=reason):
        simulate_passage(short_line(), passage, programs=[program])
