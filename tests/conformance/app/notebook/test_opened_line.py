"""Line of a case in Python: shape, droppers, elasticity and figure, against equilibrium and symmetry."""

import numpy as np
import pytest

from pantocheck.conformance import InputError, OpenedLine, open_case

SPAN = 5
"""A span of the reference line far from its ends."""


@pytest.fixture(scope="module")
def line() -> OpenedLine:
    return open_case("en50318-2002/250").line


def test_droppers_and_arms_carry_the_contact_wire(line: OpenedLine) -> None:
    """In a span of a periodic line, droppers and one arm carry the weight of the contact wire, its clamps included."""
    start, end = line.file.geometry.span(SPAN)
    droppers = line.droppers()
    inside = (np.array(droppers["position_m"]) > start) & (np.array(droppers["position_m"]) < end)
    held = np.array(droppers["force_N"])[inside].sum()
    catenary, state = line.catenary, line.discretised.state
    arm = next(n for n, arm in enumerate(catenary.steady_arms) if arm.position == pytest.approx(end))
    masses = [dropper for dropper in catenary.droppers if start < dropper.position < end]
    weight = 9.81 * (
        catenary.contact_wires[0].mass_per_length * (end - start)
        + sum(dropper.lower_clamp_mass for dropper in masses)
        + catenary.steady_arms[arm].mass
    )
    # The tension of a dropper is that at its mid-length: half of its own mass hangs below. Rounding of the solution.
    own = 9.81 * sum(dropper.mass / 2 for dropper in masses)
    assert held + state.arm_force[arm, 1] == pytest.approx(weight + own, rel=2e-3)


def test_shape_holds_every_wire(line: OpenedLine) -> None:
    shape = line.shape()
    wires = np.array(shape["wire"])
    contact = np.array(shape["height_m"])[wires == "contact wire"]
    assert set(wires) == {"contact wire", "messenger wire"}
    assert abs(contact).max() < 0.05  # the line has no pre-sag: it only sags between its droppers
    encumbrance = line.file.geometry.encumbrance_m
    assert np.array(shape["height_m"])[wires == "messenger wire"].max() == pytest.approx(encumbrance, abs=0.01)


def test_elasticity_is_symmetric_and_grows_when_droppers_slacken(line: OpenedLine) -> None:
    start, end = line.file.geometry.span(SPAN)
    offset = np.array([10.0, 25.0])
    small, mirrored = line.elasticity(start + offset), line.elasticity(end - offset)
    assert small == pytest.approx(mirrored, rel=1e-4)  # the ends of the line are five spans away
    # A dropper carries at most 0.1 kN: under 600 N, those beside the force are slack.
    assert (line.elasticity(start + offset, 600.0) > 1.02 * small).all()


@pytest.mark.parametrize(("position", "force", "message"), [(-1.0, 1.0, "not on the line"), (10.0, 0.0, "above zero")])
def test_wrong_place_or_force_is_refused(line: OpenedLine, position: float, force: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        line.elasticity(position, force)


def test_figure_shows_the_requested_spans(line: OpenedLine) -> None:
    pytest.importorskip("matplotlib").use("agg")
    axes = line.plot(SPAN, SPAN + 1)
    start, end = line.file.geometry.section(SPAN, SPAN + 1)
    drawn = np.concatenate([curve.get_xdata() for curve in axes.lines])
    assert (drawn.min(), drawn.max()) == (start, end)
    droppers = [curve for curve in axes.lines if np.ptp(curve.get_xdata()) == 0 and len(curve.get_xdata()) == 2]
    assert len(droppers) == 2 * len(line.file.droppers.x_m)
    with pytest.raises(InputError, match="Give spans from 1 to"):
        line.plot(3, 2)
