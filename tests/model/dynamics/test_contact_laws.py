"""Contact laws in a passage: Hertz's law, the limit of stiff springs, closed forms, energy."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, simple_line
from pantocheck.model import History, Passage, discretise, simulate_passage
from pantocheck.model.description.contact_law import contact_compliance, hertz_law_coefficient, penetration
from pantocheck.model.dynamics.contact_step import reduce_by_hertz
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from verification.guide.topics.contact_laws import HEADS, impact_error, measure_ledger

HERTZ = replace(PANTOGRAPH_2002, contact_stiffness=np.inf, hertz_coefficient=1.2e7)
"""A soft Hertz contact, 0.46 mm at 120 N: the law decides the force, not the mesh."""


def test_coefficient_and_penetration_of_hertz() -> None:
    """Steel ball of 10 mm radius on steel (E = 210 GN/m2, nu = 0.3): 8.2 um at 100 N, by the formula of Johnson."""
    modulus = 1 / (2 * (1 - 0.3**2) / 210e9)
    coefficient = hertz_law_coefficient(modulus, 0.01)
    assert penetration(np.inf, coefficient, 100.0) == pytest.approx((9 * 100**2 / (16 * modulus**2 * 0.01)) ** (1 / 3))
    change = penetration(np.inf, coefficient, 100.001) - penetration(np.inf, coefficient, 99.999)
    assert contact_compliance(np.inf, coefficient, 100.0) == pytest.approx(change / 0.002, rel=1e-6)
    assert contact_compliance(5e4, np.inf, 100.0) == 1 / 5e4
    np.testing.assert_array_equal(penetration(5e4, np.inf, np.array([0.0, 100.0])), [0.0, 100.0 / 5e4])


@pytest.mark.parametrize("share", [1e-9, 1e-3, 1.0, 1e3, 1e12])
def test_reduction_by_hertz_solves_its_equation(share: float) -> None:
    """Newton's method ends at the accuracy of the numbers, also where one of the terms is negligible."""
    for linear in (1e-9, 1.0, 300.0, 1e6):
        force = reduce_by_hertz(linear, share)
        assert force + share * force ** (2 / 3) == pytest.approx(linear, rel=1e-12)


def test_hertz_contact_obeys_its_law_at_the_end_of_every_step() -> None:
    """Force from closing and rate of head and wire at the end of a step, which the kernel does not keep.

    The rate at the end is the predicted one and half a step of acceleration. Sweeps stop at changes of 1e-9 N; a soft
    contact leaves 1e-6 N. Contact is lost and regained.
    """
    line, dt = discretise(simple_line(4, 50.0, (5.0, 25.0, 45.0), DAMPED), 1.0), 1e-3
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, Passage((HERTZ,), (12.0,), 90.0, 1.0, dt))
    work = build_workspace(kernel, train)
    assert penetration(np.inf, HERTZ.hertz_coefficient, 120.0) > 4e-4
    train.z[1] -= 0.8
    errors, forces = [], []
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(1000):
        assert advance()
        force, k, c = train.contact[0, 0], work.contact.stiffness[0, 0], work.contact.damping[0, 0]
        e, s = work.contact.element[0], work.contact.shape[0, 0]
        ends = [motion.w[:, 0, e], motion.r[:, 0, e], motion.w[:, 0, e + 1], motion.r[:, 0, e + 1]]
        rest = s @ line.state.deflection[line.contact_rows[0], e : e + 2].ravel()
        wire = sum(n * np.array([q + dt**2 / 4 * a, dt / 2 * a]) for n, (q, _, a) in zip(s, ends, strict=True))
        closing = HERTZ.head @ train.z[0, 0] - rest - wire[0]
        rate = work.contact.rate[0, 0] + dt / 2 * HERTZ.head @ train.z[2, 0] - wire[1]
        free = k * closing + c * rate
        hertz = k * penetration(np.inf, HERTZ.hertz_coefficient, force)
        errors.append(force + hertz - free if force > 0 else max(free, 0.0))
        forces.append(force)
    assert 20 < np.sum(np.array(forces) == 0.0) < 500
    assert np.abs(errors).max() < 1e-6


def test_stiff_springs_tend_to_the_constraint() -> None:
    """Bands below 50 Hz: 1e6 N/m within 4 %, 1e8 N/m within 0.5 %, with elements of 0.25 m."""
    line = discretise(simple_line(4, 50.0, (5.0, 15.0, 25.0, 35.0, 45.0), DAMPED), 0.25)

    def run(stiffness: float) -> History:
        head = replace(PANTOGRAPH_2002, contact_stiffness=stiffness)
        return simulate_passage(line, Passage((head,), (40.0,), 70.0, 1.6, 5e-4))

    constraint = band_values(run(np.inf))
    for stiffness, tolerance in ((1e6, 0.04), (1e8, 0.005)):
        np.testing.assert_allclose(band_values(run(stiffness)), constraint, rtol=tolerance)
    assert abs(band_values(run(5e4))[2] / constraint[2] - 1) > 0.1  # the library's spring is far from it


def band_values(history: History) -> np.ndarray:
    """RMS of the force in 0-5, 5-20 and 20-50 Hz over the second half of a passage."""
    force = history.force[0][history.force[0].size // 2 :]
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, history.time[1] - history.time[0])
    edges = [(0, 5), (5, 20), (20, 50)]
    return np.sqrt([power[(frequency > low) & (frequency <= high)].sum() for low, high in edges])


def test_impact_on_a_string_has_the_impulse_and_the_force_of_the_closed_form() -> None:
    """Elements of 0.5 m, 1 ms: measured errors of 0.03 % and 2.6 %; without the damper the force is 54 % wrong."""
    impulse, force = impact_error(0.5, 1e-3)
    assert abs(impulse) < 1e-3
    assert force < 0.035


@pytest.mark.parametrize("law", ["spring", "constraint", "hertz"])
def test_energy_balance_holds_through_losses_of_contact(law: str) -> None:
    """To 1e-6 of the energy that uplift force and train put in; a contact may take energy, but 0.1 % at most is made.

    Measured: 1e-14 in the balance. A spring gains 0.02 % where contact is lost within a step, the dampers of a
    constraint take 1.3 %.
    """
    ledger = measure_ledger(law)
    assert ledger.losses > 0
    assert ledger.error < 1e-6
    assert -1e-3 < ledger.lost_in_contact < 0.02


@pytest.mark.parametrize("law", ["spring", "constraint"])
@pytest.mark.parametrize("head", list(HEADS)[1:])
def test_energy_balance_holds_with_every_structure_of_the_head(law: str, head: str) -> None:
    """As above, 1e-14 measured; friction only takes energy, a stop between time steps returns it to 0.1 %."""
    ledger = measure_ledger(law, 1.0, 2e-3, head=head)
    assert ledger.error < 1e-6
    assert ledger.losses > 0 or law == "spring"
    if head in ("friction", "stops"):
        assert min(ledger.bounds, ledger.inside) > 5  # slides and sticks, or touches and leaves the stops
    lowest, highest = {"friction": (0.01, 0.1), "stops": (-1e-3, 0.02)}.get(head, (0.0, 0.0))
    assert lowest <= ledger.taken_by_joints <= highest


def test_energy_that_a_constraint_takes_vanishes_with_the_mesh() -> None:
    """Order one: 2.3 % at 1 m, 1.3 % at 0.5 m."""
    coarse, fine = (measure_ledger("constraint", h, 2e-3 * h).lost_in_contact for h in (1.0, 0.5))
    assert fine < 0.65 * coarse
