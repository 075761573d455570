"""Drawing of a line at rest: its section, its parts, and the hinges of its steady arms."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.cases.geometry import Geometry
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.line_drawing import draw_line
from pantocheck.model import DiscretisedLine, Kind, discretise


def build_line(name: str, spans: int) -> tuple[DiscretisedLine, Geometry]:
    line = select_cases([name])[0].line
    line = line.model_copy(update={"geometry": line.geometry.shorten(spans)})
    return discretise(build_catenary(line), 2.0), line.geometry


def paint(line: DiscretisedLine, geometry: Geometry) -> Figure:
    figure = draw_line.__wrapped__(line, "Line", geometry)  # type: ignore[attr-defined]
    assert isinstance(figure, Figure)
    return figure


def marks(axes: Axes, marker: str) -> list[float]:
    """Positions of the marks of a kind along the track [m]."""
    return sorted(float(drawn.get_xdata()[0]) for drawn in axes.lines if drawn.get_marker() == marker)


@pytest.fixture(scope="module")
def staggered() -> tuple[DiscretisedLine, Geometry]:
    """Six spans; the first steady arm pushes instead of pulling, as drawn only."""
    line, geometry = build_line("en50318-2018/ac-simple/static", 6)
    arms = line.catenary.steady_arms
    arms = tuple(replace(arm, acts="push" if i % 2 else "pull") for i, arm in enumerate(arms))
    return replace(line, catenary=replace(line.catenary, steady_arms=arms)), geometry


def test_two_spans_and_half_a_span_on_either_side_are_shown(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """Of six spans: from the middle of the second to the middle of the fifth; supports and arms at their ends."""
    line, geometry = staggered
    side, plan = paint(line, geometry).axes
    span = geometry.span_lengths[0]
    assert side.get_xlim() == pytest.approx((1.5 * span, 4.5 * span))
    assert side.get_shared_x_axes().joined(side, plan)
    for axes in (side, plan):
        assert marks(axes, "^") == pytest.approx([2 * span, 3 * span, 4 * span])
        assert marks(axes, "o") == pytest.approx([2 * span, 3 * span, 4 * span])
        assert all(0 < drawn.get_markersize() <= 6 for drawn in axes.lines)
    assert (side.get_ylabel(), plan.get_ylabel()) == ("height [m]", "lateral [m]")
    assert (side.get_title("left"), plan.get_title("left")) == ("Line: side view", "plan view")
    assert plan.get_xlabel().startswith("along the track [m]; heights and lateral positions 10 times")
    droppers = [d.position for d in line.catenary.droppers if 1.5 * span <= d.position <= 4.5 * span]
    vertical = sorted(float(d.get_xdata()[0]) for d in side.lines if len(d.get_xdata()) == 2)
    assert vertical == pytest.approx(sorted(droppers))


def test_lengths_of_one_span_are_written_at_its_droppers(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    line, geometry = staggered
    side, plan = paint(line, geometry).axes
    start, end = geometry.span(4)
    expected = {
        d.position: f"{length:.3f}"
        for d, length in zip(line.catenary.droppers, line.state.dropper_length, strict=True)
        if start <= d.position < end
    }
    assert {text.xy[0]: text.get_text() for text in side.texts} == expected
    assert not plan.texts
    for text in side.texts:
        drawn = next(d for d in side.lines if len(d.get_xdata()) == 2 and d.get_xdata()[0] == text.xy[0])
        assert text.xy[1] == pytest.approx(np.mean(drawn.get_ydata()))


def test_wires_have_their_shape_and_width(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """The width of a line tells contact wire, messenger wire and stitch wire apart, the contact wire the thickest."""
    line, geometry = staggered
    side, plan = paint(line, geometry).axes
    for axes, field in ((side, "z"), (plan, "y")):
        wires = [drawn for drawn in axes.lines if len(drawn.get_xdata()) > 2]
        assert len(wires) == len(line.catenary.wires)
        for drawn, wire in zip(wires, line.catenary.wires, strict=True):
            assert drawn.get_xdata() == pytest.approx(line.mesh.position)
            assert drawn.get_ydata() == pytest.approx(line.state.deflection[line.mesh.row_of[wire.name, field], :, 0])
    stitched, geometry = build_line("en50318-2018/ac-stitched/static", 4)
    widths: dict[Kind, set[float]] = {}
    drawn_wires = [drawn for drawn in paint(stitched, geometry).axes[0].lines if len(drawn.get_xdata()) > 2]
    start, end = 0.5 * geometry.span_lengths[0], 3.5 * geometry.span_lengths[0]
    inside = [wire for wire in stitched.catenary.wires if wire.end >= start and wire.start <= end]
    for drawn, wire in zip(drawn_wires, inside, strict=True):
        assert drawn.get_xdata()[[0, -1]] == pytest.approx([wire.start, wire.end])
        widths.setdefault(wire.kind, set()).add(drawn.get_linewidth())
    order = [widths[kind].pop() for kind in (Kind.STITCH_WIRE, Kind.MESSENGER_WIRE, Kind.CONTACT_WIRE)]
    assert order == sorted(set(order))
    assert order[2] >= 2 * order[0]


def test_hinge_of_an_arm_lies_on_the_side_of_a_pull_and_opposite_a_push(
    staggered: tuple[DiscretisedLine, Geometry],
) -> None:
    line, geometry = staggered
    _, plan = paint(line, geometry).axes
    span, row = geometry.span_lengths[0], line.mesh.row_of[line.catenary.contact_wires[0].name, "y"]
    seen = set()
    for arm, force in zip(line.catenary.steady_arms, line.state.arm_force, strict=True):
        if not 1.5 * span <= arm.position <= 4.5 * span:
            continue
        claw = line.state.deflection[row, line.mesh.station(arm.position), 0]
        (drawn,) = (
            d
            for d in plan.lines
            if len(d.get_xdata()) == 2 and d.get_xdata()[0] == arm.position and d.get_linewidth() == 1.0
        )
        side = np.sign(force[0]) * (1 if arm.acts == "pull" else -1)
        assert drawn.get_ydata() == pytest.approx([claw, claw + side * arm.length])
        seen.add((arm.acts, side))
    assert {acts for acts, _ in seen} == {"pull", "push"}


def test_arm_without_a_lateral_force_has_no_hinge(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """A force of half a newton still gives its side, no force does not."""
    line, geometry = staggered
    count = [d.get_linewidth() for d in paint(line, geometry).axes[1].lines].count(1.0)
    for factor, left in ((0.0, 0), (0.5 / np.abs(line.state.arm_force[:, 0]).max(), count)):
        weak = replace(line, state=replace(line.state, arm_force=factor * line.state.arm_force))
        assert [d.get_linewidth() for d in paint(weak, geometry).axes[1].lines].count(1.0) == left
    assert count == 3


@pytest.mark.parametrize(("spans", "ends"), [(2, (0.0, 2.0)), (3, (0.5, 3.0))])
def test_short_line_is_shown_to_its_ends(spans: int, ends: tuple[float, float]) -> None:
    line, geometry = build_line("en50318-2002/250", spans)
    (side,) = paint(line, geometry).axes
    assert side.get_xlim() == pytest.approx(np.array(ends) * geometry.span_lengths[0])
    assert side.get_xlabel() != ""
