"""Line in a curve: radial forces, plan shape relative to the track, and position of the head on a canted track."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from pantocheck.model import Catenary, Kind, SteadyArm, TrackCurve, Wire, discretise
from pantocheck.model.description.curves import curvature, head_shift

SPAN, TENSION, BENDING = 60.0, 20e3, 195.0
BENDING_LENGTH = np.sqrt(BENDING / TENSION)


def wire_on_arms(staggers: list[float], curves: tuple[TrackCurve, ...]) -> Catenary:
    """Contact wire with hinged arms at the supports and anchors at both ends, with staggers from end to end."""
    plan = tuple((SPAN * n, y) for n, y in enumerate(staggers))
    end = plan[-1][0]
    wire = Wire("contact", Kind.CONTACT_WIRE, 0.0, end, TENSION, 1.35, BENDING, stagger=plan)
    arms = tuple(SteadyArm(x, "contact", length=1.2, carries_share=True) for x, _ in plan[1:-1])
    return Catenary((wire,), steady_arms=arms, curves=curves)


@pytest.mark.parametrize("radius", [600.0, -1500.0])
@pytest.mark.parametrize("stagger", [0.0, 0.2])
def test_radial_force_of_an_arm_is_tension_times_angle(radius: float, stagger: float) -> None:
    """Outwards T L / R, and the force of the zigzag of stagger a: 4 a T / (L - 2 l), where l is the bending length.

    In the middle of seven spans of a regular line; the ends change a force by (l / L)^3. Elements of
    0.05 m resolve l = 0.1 m.
    """
    staggers = [stagger * (-1) ** n for n in range(8)]
    line = discretise(wire_on_arms(staggers, (TrackCurve(-1.0, 421.0, radius),)), 0.05)
    radial = TENSION * SPAN / radius
    zigzag = 4 * stagger * TENSION / (SPAN - 2 * BENDING_LENGTH)
    # Arms 3 and 4 stand at 180 m (stagger -a) and 240 m (stagger +a).
    assert line.state.arm_force[2:4, 0] == pytest.approx([-zigzag - radial, zigzag - radial], rel=1e-5)


def test_shape_between_supports_is_a_parabola_towards_the_centre() -> None:
    """q L^2 / 8 T less q L l / 2 T of the horizontal ends, with q = T / R: 750 mm less 5 mm at R = 600 m."""
    line = discretise(wire_on_arms([0.0] * 8, (TrackCurve(-1.0, 421.0, 600.0),)), 0.05)
    row = line.mesh.row_of["contact", "y"]
    middle = line.state.deflection[row, line.mesh.station(210.0), 0]
    expected = SPAN**2 / (8 * 600) - SPAN * BENDING_LENGTH / (2 * 600)
    assert middle == pytest.approx(expected, rel=1e-5)
    away = discretise(wire_on_arms([0.0] * 8, (TrackCurve(-1.0, 421.0, -600.0),)), 0.05)
    np.testing.assert_allclose(away.state.deflection[row, :, 0], -line.state.deflection[row, :, 0], atol=1e-12)


def test_wire_over_a_curve_with_transitions_is_straight_in_space() -> None:
    """Centre line plus wire is a chord from anchor to anchor; elements of 0.25 m take the mean of a transition."""
    curve = TrackCurve(20.0, 90.0, 800.0, transition=25.0)
    line = discretise(wire_on_arms([0.1, -0.1, 0.3], (curve,)), 0.25)
    x = line.mesh.position
    fine = np.linspace(0.0, 120.0, 48_001)
    slope = cumulative_trapezoid(curvature((curve,), fine), fine, initial=0.0)
    track = np.interp(x, fine, cumulative_trapezoid(slope, fine, initial=0.0))
    absolute = track + line.state.deflection[line.mesh.row_of["contact", "y"], :, 0]
    for inside in ((x > 2.0) & (x < 58.0), (x > 62.0) & (x < 118.0)):
        chord = np.polyval(np.polyfit(x[inside], absolute[inside], 1), x[inside])
        np.testing.assert_allclose(absolute[inside], chord, atol=2e-5)


def test_curvature_and_cant_rise_over_the_transitions() -> None:
    """A curve to the right: full values between the transitions, half of them in the middle of a transition."""
    curves = (TrackCurve(100.0, 300.0, -500.0, transition=40.0, cant=0.12), TrackCurve(300.0, 350.0, 1000.0))
    x = np.array([50.0, 110.0, 120.0, 140.0, 200.0, 280.0, 320.0, 400.0])
    np.testing.assert_allclose(curvature(curves, x) * 500, [0, -0.25, -0.5, -1, -1, -0.5, 0.5, 0], atol=1e-12)
    # 5.3 m times 0.12 m over 1.5 m: the head leans 0.424 m towards the centre of the curve.
    shift = head_shift(curves, x, rail_distance=1.5, wire_height=5.3)
    np.testing.assert_allclose(shift, -0.424 * np.array([0, 0.25, 0.5, 1, 1, 0.5, 0, 0]), atol=1e-12)
