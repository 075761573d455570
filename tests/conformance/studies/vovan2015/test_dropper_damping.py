"""The dropper's compensation force against its stiffness coefficient: where it changes, and what locks a dropper."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.testing import assert_allclose

from helpers.computed_modes import verdicts
from helpers.lines import simple_line
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.studies.vovan2015.dropper_damping import find_transition, run_dropper_damping
from pantocheck.model import Kind, Passage, Rayleigh, chain, discretise, simulate_passage
from pantocheck.model.discretised_line import with_damping, with_viscous_part_kept

COEFFICIENTS = np.geomspace(1e-6, 1e-1, 51)


def low_pass_curve(corner):
    """Force that falls like 1 / (1 + (a / corner)^2)."""
    return 1000 / (1 + (COEFFICIENTS / corner) ** 2)


def test_levels_of_a_known_curve():
    """Half is left at the corner, 90 % at a third and 10 % at three times of it; points lie 26 % apart."""
    found = find_transition(COEFFICIENTS, low_pass_curve(2e-3))
    assert_allclose(found["dropper_transition_start_s"], 2e-3 / 3, rtol=0.03)
    assert_allclose(found["dropper_transition_middle_s"], 2e-3, rtol=0.01)
    assert_allclose(found["dropper_transition_end_s"], 6e-3, rtol=0.03)
    assert_allclose(found["dropper_locked_force_pct"], 100 / (1 + 50**2), rtol=1e-3)


def test_a_dropper_that_never_slackens_has_no_transition():
    """There is no force whose share could be told."""
    with np.errstate(all="raise"):
        assert find_transition(COEFFICIENTS, np.zeros(COEFFICIENTS.size)) == {}


def graded(force):
    (case,) = select_cases(["vovan2015/dropper-damping"])
    rows = verdicts(case, {LINE: find_transition(COEFFICIENTS, force)})
    return {quantity.removeprefix("dropper_"): row.verdict for (quantity, _), row in rows.items()}


def test_a_transition_out_of_place_is_caught():
    start, middle, end, locked = "transition_start_s", "transition_middle_s", "transition_end_s", "locked_force_pct"
    assert graded(low_pass_curve(2e-3)) == dict.fromkeys((start, middle, end, locked), "pass")
    assert graded(low_pass_curve(2e-4))[start] == "fail"
    late = graded(low_pass_curve(0.06))
    assert late == {start: "fail", middle: "fail", end: "skip", locked: "fail"}  # the end is not reached


def test_a_dropper_that_never_locks_is_caught():
    """No transition is not a pass: there is nothing to grade, and the force that is left is too much."""
    found = graded(np.full(COEFFICIENTS.size, 1000.0))
    assert found["transition_middle_s"] == "skip"
    assert found["locked_force_pct"] == "fail"


def test_the_law_that_compensates_the_elastic_force_locks_and_the_other_does_not():
    (case,) = select_cases(["vovan2015/dropper-damping"])
    coarse = case.file.discretisation.model_copy(update={"element_m": 1.5, "time_step_s": 0.002})
    study = case.file.study.model_copy(update={"coefficients_s": (1e-6, 3e-3, 1e-1), "x_m": 283.5})
    file = case.file.model_copy(
        update={"discretisation": coarse, "study": study, "evaluated_spans": (4, 5), "run_out_m": 0.0}
    )
    outcome = run_dropper_damping(replace(case, file=file), study)
    (chart,) = outcome.study.charts
    nothing, elastic = (series.y for series in chart.series)
    # Neither law knows the other without damping: they agree to what a coefficient of 1e-6 s does.
    assert_allclose(nothing[0], elastic[0], rtol=0.01)
    assert nothing[-1] > nothing[0]
    assert elastic[-1] < 0.1 * elastic[0]
    assert outcome.study.findings[LINE]["dropper_locked_force_pct"] < 10
    assert outcome.record is not None


def test_both_laws_are_the_same_while_every_dropper_is_taut():
    """Two linear systems with the same matrices, that go apart as soon as one dropper slackens.

    Only rounding may differ, 1e-13 of the displacement measured; a dashpot wrong by a thousandth gives 2e-5.
    """
    line = simple_line(damping={Kind.DROPPER: Rayleigh(stiffness_coefficient=1e-3)})
    mesh = discretise(line, 2.0)
    kept = with_viscous_part_kept(mesh)
    assert kept.connectors.damping.sum() == mesh.connectors.damping.sum()
    assert not kept.connectors.unilateral[mesh.connectors.station.size :].any()
    # Another damping makes the connectors anew: the law is to be laid over it last.
    assert with_damping(kept, line.damping).connectors.station.size == mesh.connectors.station.size
    light, heavy = taut_and_apart(mesh, kept, 5.0), taut_and_apart(mesh, kept, 200.0)
    assert light.smallest > 0  # every dropper pulls at every time
    assert light.moved > 1e-4  # and the line does move
    assert light.apart < 1e-10 * light.moved
    assert heavy.smallest < 0
    assert heavy.apart > 1e-3 * heavy.moved


@dataclass(frozen=True)
class Pair:
    """Two runs: smallest dropper force [N], largest displacement and largest difference at the droppers [m]."""

    smallest: float
    moved: float
    apart: float


def taut_and_apart(mesh, other, uplift):
    """A head pressed up with a constant force, over most of two lines."""
    head = chain(np.array([5.0]), np.array([0.0]), np.array([20.0]), uplift, 0, 50e3)
    droppers = mesh.catenary.droppers
    watched = tuple((wire, one.position) for one in droppers for wire in (one.upper, one.lower))
    passage = Passage((head,), (20.0,), 50.0, 1.0, 0.002, watched)
    motion, compared = (simulate_passage(line, passage).motion for line in (mesh, other))
    change = motion[0::2] - motion[1::2]
    bars, count = mesh.connectors, len(droppers)
    assert bars.unilateral[:count].all()
    force = bars.preload[:count, None] + bars.stiffness[:count, None] * change[..., 0]
    force += bars.damping[:count, None] * change[..., 1]
    return Pair(force.min(), np.abs(motion[..., 0]).max(), np.abs(compared - motion)[..., 0].max())
