"""Static shape with given dropper lengths: closed forms, the solver with slack droppers, and a round trip."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import simple_line
from pantocheck.model import Catenary, Clamp, Dropper, Kind, MessengerSupport, Wire, discretise, make_droppers_bilateral
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.dropper_lengths import compute_unloaded_lengths, hang_on_droppers, unloaded_lengths
from pantocheck.model.statics.assembly import connector_directions
from pantocheck.model.statics.static_solver import StaticSolver


def zigzag_line() -> Catenary:
    """Three spans of 40 m with a zigzag of 0.3 m on hinged arms, pre-sag, and stitch wires at both supports."""
    line = simple_line(spans=3, span=40.0, droppers=(3.0, 12.0, 20.0, 28.0, 37.0))
    contact, messenger = line.wires
    staggers = tuple((40.0 * n, 0.3 * (-1) ** n) for n in range(4))
    stitches = tuple(Wire(f"stitch {x}", Kind.STITCH_WIRE, x - 6.0, x + 6.0, 3e3, 0.3, 10.0) for x in (40.0, 80.0))
    upper = {x + side: f"stitch {x}" for x in (40.0, 80.0) for side in (-3.0, 3.0)}
    sag = dict(zip((3.0, 12.0, 20.0, 28.0, 37.0), (0.0, 0.02, 0.03, 0.02, 0.0), strict=True))
    return replace(
        line,
        wires=(
            replace(contact, stagger=staggers),
            replace(messenger, stagger=tuple((x, 0.0) for x, _ in staggers)),
            *stitches,
        ),
        droppers=tuple(
            replace(d, upper=upper.get(d.position, "messenger"), contact_wire_height=-sag[d.position % 40.0])
            for d in line.droppers
        ),
        steady_arms=tuple(replace(arm, vertical_stiffness=None, length=1.2) for arm in line.steady_arms),
        clamps=tuple(Clamp(x, "messenger", wire.name) for wire in stitches for x in (wire.start, wire.end)),
    )


@pytest.mark.parametrize("line", [simple_line(), zigzag_line()], ids=["level", "zigzag with stitch wires"])
def test_lengths_are_reached_and_lead_back(line: Catenary) -> None:
    """Droppers longer or shorter by up to 3 mm: the varied line has these lengths, and the way back its old heights."""
    nominal = compute_unloaded_lengths(line, 1.0)
    change = 0.003 * np.cos(np.arange(nominal.size))
    varied = hang_on_droppers(line, nominal + change, 1.0)
    np.testing.assert_allclose(unloaded_lengths(varied, discretise(varied, 1.0).state), nominal + change, atol=1.1e-9)
    back = hang_on_droppers(varied, nominal, 1.0)
    heights = [[d.contact_wire_height for d in catenary.droppers] for catenary in (line, varied, back)]
    assert np.abs(np.subtract(heights[1], heights[0])).max() > 1e-3
    np.testing.assert_allclose(heights[2], heights[0], atol=1e-8)


def test_line_with_its_own_lengths_is_unchanged() -> None:
    """Not a bit of it."""
    line = zigzag_line()
    assert hang_on_droppers(line, compute_unloaded_lengths(line, 2.0), 2.0) == line


def test_one_longer_dropper_lowers_the_wire_by_the_flexibility_of_both_wires() -> None:
    """Two strings of 40 m with one dropper of stiffness k at mid-span, lengthened by r: closed form.

    It relieves itself by r / (1/k + L / 4T1 + L / 4T2), and the contact wire falls by this force times L / 4T1.
    Bending reduces the point flexibility by l / 2T with l = sqrt(EI / T) = 0.02 m; strings of 1e-9 N m2 have none.
    """
    span, contact, messenger, stiffness = 40.0, 20e3, 16e3, 2e4
    line = Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, span, contact, 1.35, 1e-9),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, span, messenger, 1.07, 1e-9),
        ),
        droppers=(Dropper(20.0, "messenger", "contact", stiffness=stiffness),),
        messenger_supports=(
            MessengerSupport(0.0, "messenger", 1.2, 5e4),
            MessengerSupport(span, "messenger", 1.2, 5e4),
        ),
    )
    # Elements with a slope at both ends are too stiff at the kink under a point force; 0.02 m leaves 1e-4.
    element, lengthening = 0.02, 0.004
    varied = hang_on_droppers(line, compute_unloaded_lengths(line, element) + lengthening, element)
    relief = lengthening / (1 / stiffness + span / (4 * contact) + span / (4 * messenger))
    assert varied.droppers[0].contact_wire_height == pytest.approx(-relief * span / (4 * contact), rel=1e-3)
    forces = [discretise(catenary, element).state.dropper_tension[0] for catenary in (line, varied)]
    assert forces[0] - forces[1] == pytest.approx(relief, rel=1e-3)


def test_varied_state_is_the_linear_response_of_the_line_with_rigid_supports() -> None:
    """Lengthening r is the load k r at both ends of a dropper; the solver of statics has another formulation.

    Its connectors contain the residual flexibility of elements, which a prescribed height does not see: 1 % at 0.25 m.
    """
    line = simple_line(carries_share=False)
    line = replace(
        line,
        messenger_supports=tuple(replace(s, stiffness=1e9) for s in line.messenger_supports),
        steady_arms=tuple(replace(arm, vertical_stiffness=0.0) for arm in line.steady_arms),
    )
    element, change = 0.25, 0.002 * np.sin(np.arange(len(line.droppers)))
    varied = hang_on_droppers(line, compute_unloaded_lengths(line, element) + change, element)
    discretised = make_droppers_bilateral(discretise(line, element))
    load = connector_directions(discretised) @ (discretised.connectors.stiffness * change)
    displacement = StaticSolver(discretised).deflection(load).displacement
    stations = [discretised.mesh.station(d.position) for d in line.droppers]
    expected = displacement[discretised.contact_rows[0], stations, 0]
    computed = np.array([d.contact_wire_height for d in varied.droppers])
    np.testing.assert_allclose(computed, expected, atol=0.02 * np.abs(expected).max())


def test_dropper_that_would_be_slack_is_refused() -> None:
    """A dropper that is 0.1 m too long carries nothing at rest; a simulation needs taut droppers."""
    line = simple_line()
    length = compute_unloaded_lengths(line, 2.0)
    length[4] += 0.1
    with pytest.raises(
        NoInitialState, match=r"with the lengths of its droppers .* dropper at x = 30 m would have to push"
    ):
        hang_on_droppers(line, length, 2.0)
