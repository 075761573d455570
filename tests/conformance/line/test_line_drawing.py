"""Drawing of a line at rest: its rows, its parts, and the hinges of its steady arms."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from helpers.section_lines import section_line
from pantocheck.conformance.app.commands.line_file_command import list_marks
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.point_mass import PointMasses
from pantocheck.conformance.line.geometry import Geometry, ListedSpans
from pantocheck.conformance.line.line_drawing import (
    LABEL_SPACE,
    ROW_LENGTH,
    DrawnMark,
    LineDrawing,
    divide_into_pages,
    divide_into_rows,
    draw_line_pdf,
    draw_line_svg,
    paint_rows,
)
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import DiscretisedLine, Kind, PointMass, discretise


def build_line(name: str, spans: int) -> tuple[DiscretisedLine, Geometry]:
    line = select_cases([name])[0].line
    line = line.model_copy(update={"geometry": line.geometry.shorten(spans)})
    return discretise(build_catenary(line), 2.0), line.geometry


def paint(line: DiscretisedLine, geometry: Geometry, marks: tuple[DrawnMark, ...] = ()) -> Figure:
    drawing = LineDrawing(line, "Line", geometry, marks)
    return paint_rows(drawing, drawing.rows, 10.0)


def points(axes: Axes, marker: str) -> list[float]:
    """Positions of the points of a kind along the track [m]."""
    return sorted(float(drawn.get_xdata()[0]) for drawn in axes.lines if drawn.get_marker() == marker)


def texts(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


@pytest.fixture(scope="module")
def staggered() -> tuple[DiscretisedLine, Geometry]:
    """Eight spans of 55 m in two rows; every second steady arm pushes instead of pulling, as drawn only."""
    line, geometry = build_line("en50318-2018/ac-simple/static", 8)
    arms = line.catenary.steady_arms
    arms = tuple(replace(arm, acts="push" if i % 2 else "pull") for i, arm in enumerate(arms))
    return replace(line, catenary=replace(line.catenary, steady_arms=arms)), geometry


def test_all_spans_supports_and_droppers_stand_in_rows(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """Two rows of four spans, side view above plan view, at one scale; the support between them is in both rows."""
    line, geometry = staggered
    views = paint(line, geometry).axes
    assert len(views) == 4
    limits = geometry.span_limits
    for first, (side, plan) in zip((0, 4), (views[:2], views[2:]), strict=True):
        inside = [x for x in geometry.supports if limits[first] <= x <= limits[first + 4]]
        for axes in (side, plan):
            assert axes.get_xlim() == pytest.approx((limits[first], limits[first + 4]))
            assert points(axes, "^") == pytest.approx(inside)
            assert points(axes, "o") == pytest.approx(inside)
            assert axes.get_position().width == pytest.approx(views[0].get_position().width)
        droppers = [d.position for d in line.catenary.droppers if limits[first] <= d.position <= limits[first + 4]]
        vertical = sorted(float(d.get_xdata()[0]) for d in side.lines if len(d.get_xdata()) == 2)
        assert vertical == pytest.approx(sorted(droppers))
        assert [text for text in texts(side) if text.startswith("span")] == [
            f"span {n}: {geometry.span_lengths[0]:g} m" for n in range(first + 1, first + 5)
        ]
    assert [text for text in texts(views[0]) if text.startswith(("support", "end"))] == [
        "end", "support 1", "support 2", "support 3", "support 4"
    ]  # fmt: skip
    assert (views[0].get_ylabel(), views[1].get_ylabel()) == ("height [m]", "y [m]")


def test_stated_enlargement_is_that_of_the_axes(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """Inches per metre upwards over inches per metre along the track, rounded."""
    line, geometry = staggered
    figure = paint(line, geometry)
    heading = figure.texts[1].get_text()
    for axes, name in zip(figure.axes, ("heights", "lateral positions"), strict=False):
        size = figure.get_size_inches() * (axes.get_position().width, axes.get_position().height)
        along, upward = size / (np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
        stated = float(heading.split(f"{name} ")[1].split(" ")[0])
        assert upward / along == pytest.approx(stated, abs=0.51)


def test_lengths_are_written_at_the_droppers(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    line, geometry = staggered
    side = paint(line, geometry).axes[0]
    expected = {
        d.position: f"{length:.3f}"
        for d, length in zip(line.catenary.droppers, line.state.dropper_length, strict=True)
        if d.position <= geometry.span_limits[4]
    }
    written = {text.xy[0]: text.get_text() for text in side.texts if text.get_rotation() == 90}
    assert written == expected


def test_lengths_that_would_overlap_are_left_out() -> None:
    """Spans of 10 m with a dropper every metre: 400 m in a row, so that not every dropper has its length."""
    line = select_cases(["en50318-2002/250"])[0].line
    geometry = line.geometry.model_copy(update={"span_m": 10.0, "spans": 40})
    droppers = line.droppers.model_copy(update={"x_m": tuple(range(1, 10)), "presag_m": None, "length_m": None})
    short = line.model_copy(update={"geometry": geometry, "droppers": droppers})
    drawing = LineDrawing(discretise(build_catenary(short), 2.0), "Line", geometry)
    (side,) = paint_rows(drawing, drawing.rows, 10.0).axes
    places = np.array([text.xy[0] for text in side.texts if text.get_rotation() == 90])
    assert 40 < places.size < len(drawing.line.catenary.droppers)
    assert np.diff(places).min() * drawing.scale >= LABEL_SPACE


def test_wires_have_their_shape_and_width(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """The width of a line tells contact wire, messenger wire and stitch wire apart, the contact wire the thickest."""
    line, geometry = staggered
    side, plan = paint(line, geometry).axes[:2]
    inside = line.mesh.position <= geometry.span_limits[4] + 1e-6
    for axes, field in ((side, "z"), (plan, "y")):
        wires = [drawn for drawn in axes.lines if len(drawn.get_xdata()) > 2]
        assert len(wires) == len(line.catenary.wires)
        for drawn, wire in zip(wires, line.catenary.wires, strict=True):
            assert drawn.get_xdata() == pytest.approx(line.mesh.position[inside])
            row = line.mesh.row_of[wire.name, field]
            assert drawn.get_ydata() == pytest.approx(line.state.deflection[row, inside, 0])
    stitched, geometry = build_line("en50318-2018/ac-stitched/static", 4)
    widths: dict[Kind, set[float]] = {}
    drawn_wires = [drawn for drawn in paint(stitched, geometry).axes[0].lines if len(drawn.get_xdata()) > 2]
    for drawn, wire in zip(drawn_wires, stitched.catenary.wires, strict=True):
        assert drawn.get_xdata()[[0, -1]] == pytest.approx([wire.start, wire.end])
        widths.setdefault(wire.kind, set()).add(drawn.get_linewidth())
    order = [widths[kind].pop() for kind in (Kind.STITCH_WIRE, Kind.MESSENGER_WIRE, Kind.CONTACT_WIRE)]
    assert order == sorted(set(order))
    assert order[2] >= 2 * order[0]


def test_hinge_of_an_arm_lies_on_the_side_of_a_pull_and_opposite_a_push(
    staggered: tuple[DiscretisedLine, Geometry],
) -> None:
    line, geometry = staggered
    _, plan = paint(line, geometry).axes[:2]
    row = line.mesh.row_of[line.catenary.contact_wires[0].name, "y"]
    seen = set()
    for arm, force in zip(line.catenary.steady_arms, line.state.arm_force, strict=True):
        if arm.position > geometry.span_limits[4]:
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

    def count_hinges(factor: float) -> int:
        weak = replace(line, state=replace(line.state, arm_force=factor * line.state.arm_force))
        lines = paint(weak, geometry).axes[1].lines
        return sum(len(drawn.get_xdata()) == 2 and drawn.get_linewidth() == 1.0 for drawn in lines)

    half_a_newton = 0.5 / np.abs(line.state.arm_force[:, 0]).max()
    assert [count_hinges(factor) for factor in (1.0, half_a_newton, 0.0)] == [4, 4, 0]


def test_masses_and_sensors_stand_on_their_wires_with_their_texts() -> None:
    """A section insulator of the line, and the sensors and drops of a case; neighbours share one text."""
    (case,) = select_cases(["vovan2015/mass-drop/printed"])
    catenary = build_catenary(case.line)
    insulator = PointMass(100.0, catenary.contact_wires[0].name, 12.0, PointMasses.__name__)
    line = discretise(replace(catenary, point_masses=(insulator,)), 2.0)
    marks = list_marks(case, line.catenary)
    assert marks[0] == DrawnMark(PointMasses.symbol, insulator.wire, 100.0, "12 kg")
    (side,) = paint(line, case.line.geometry, marks).axes
    drops = case.file.mass_drop
    assert drops is not None
    assert points(side, "s") == sorted(sensor.x_m for sensor in drops.sensor)
    assert points(side, "v") == sorted([100.0, *(drop.x_m for drop in drops.drop)])
    drawn = [(d.get_xdata()[0], d.get_ydata()[0]) for d in side.lines if d.get_marker() in {"s", "v"}]
    written = [text for name in texts(side) for text in name.split(", ")]
    for mark in marks:
        assert mark.text in written
        row = line.mesh.row_of[mark.wire, "z"]
        height = np.interp(mark.position, line.mesh.position, line.state.deflection[row, :, 0])
        assert (mark.position, pytest.approx(height)) in drawn


def test_tension_sections_are_named_and_their_anchors_marked() -> None:
    """Two sections of six spans with an overlap of three; contact and messenger wire are anchored twice each."""
    file = section_line()
    line = discretise(build_catenary(file), 2.0)
    drawing = LineDrawing(line, "Line", file.geometry, sections=file.section_places)
    views = paint_rows(drawing, drawing.rows, 10.0).axes
    named = [text for axes in views for text in texts(axes) if text.startswith("span")]
    assert named[2:4] == ["span 3: 60 m, section 1", "span 4: 60 m, section 1 and 2"]
    assert named[5:7] == ["span 6: 60 m, section 1 and 2", "span 7: 60 m, section 2"]
    anchors = sorted({x for axes in views for x in points(axes, "D")})
    assert anchors == pytest.approx([0.0, 180.0, 360.0, 540.0])
    assert len(points(views[0], "D")) == 4


def test_rows_of_a_rising_line_keep_one_scale_and_show_their_wires() -> None:
    """The second of two rows lies 3 m higher: its axis begins 3 m higher, but for the sag of 30 mm."""
    tables = select_cases(["en50318-2002/250"])[0].line.model_dump(mode="json", exclude_none=True)
    geometry = {"span_list": [{"length_m": 60.0}] * 12, "encumbrance_m": 1.2}
    gradient = [{"from_m": 240.0, "to_m": 360.0, "slope": 0.025}]
    file = LineFile.model_validate(tables | {"geometry": geometry | {"gradient": gradient}})
    drawing = LineDrawing(discretise(build_catenary(file), 2.0), "Line", file.geometry)
    first, second = paint_rows(drawing, drawing.rows, 10.0).axes
    assert np.ptp(first.get_ylim()) == pytest.approx(np.ptp(second.get_ylim()))
    for axes in (first, second):
        low, high = axes.get_ylim()
        drawn = np.concatenate([np.asarray(d.get_ydata(), dtype=float) for d in axes.lines])
        assert low < drawn.min() < drawn.max() < high
    assert second.get_ylim()[0] == pytest.approx(first.get_ylim()[0] + 3.0, abs=0.05)


def test_length_of_a_short_dropper_stands_above_it() -> None:
    """An encumbrance of 0.8 m leaves 0.1 m at mid-span: less than the text, which is then above the messenger."""
    line = select_cases(["en50318-2002/250"])[0].line
    geometry = line.geometry.model_copy(update={"encumbrance_m": 0.8, "spans": 2})
    line = line.model_copy(update={"geometry": geometry})
    drawing = LineDrawing(discretise(build_catenary(line), 2.0), "Line", geometry)
    (side,) = paint_rows(drawing, drawing.rows, 10.0).axes
    written = [text for text in side.texts if text.get_rotation() == 90]
    positions = {text.get_va() for text in written}
    assert positions == {"center", "bottom"}
    upper = {
        d.position: drawing.view("z", drawing.rows[0]).deflection(d.upper, d.position)
        for d in drawing.line.catenary.droppers
    }
    for text in written:
        if text.get_va() == "bottom":
            assert text.xy[1] == pytest.approx(upper[text.xy[0]])


@pytest.mark.parametrize(("spans", "rows", "pages"), [(1, 1, 1), (6, 1, 1), (20, 4, 2), (66, 11, 4)])
def test_long_line_is_broken_into_rows_and_pages(spans: int, rows: int, pages: int) -> None:
    """Spans of 65 m: six in 400 m. Rows follow each other without gap, with nearly equal numbers of spans."""
    geometry = select_cases(["en50318-2018/ac-stitched/static"])[0].line.geometry
    geometry = geometry.model_copy(update={"spans": spans})
    divided = divide_into_rows(geometry)
    assert len(divided) == rows
    assert len(divide_into_pages(divided, plan_view=True)) == pages
    assert [row.first for row in divided] == [1, *(row.last + 1 for row in divided[:-1])]
    assert divided[-1].last == spans
    assert np.ptp([row.last - row.first for row in divided]) <= 1
    assert all(row.end - row.start <= ROW_LENGTH for row in divided)


def test_listed_spans_keep_one_scale() -> None:
    """Nine spans in two rows of different length."""
    (case,) = select_cases(["en50318-2002/250"])
    geometry = ListedSpans.model_validate(
        {
            "span_list": [{"length_m": 63.0}] * 5 + [{"length_m": 54.0}] * 4,
            "encumbrance_m": 1.2,
            "trust": "provisional",
            "source": "assumed",
        }
    )
    few_droppers = {"x_m": (10.0, 25.0, 40.0), "presag_m": None, "length_m": None}
    droppers = case.line.droppers.model_copy(update=few_droppers)
    line = case.line.model_copy(update={"geometry": geometry, "droppers": droppers})
    views = paint(discretise(build_catenary(line), 2.0), geometry).axes
    per_metre = [axes.get_position().width / np.ptp(axes.get_xlim()) for axes in views]
    assert per_metre == pytest.approx([per_metre[0]] * len(views))


@pytest.mark.usefixtures("fresh_figures")
def test_files_are_valid_and_the_same_every_time(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    drawing = LineDrawing(staggered[0], "Line", staggered[1])
    first, second = draw_line_svg(drawing), draw_line_svg(drawing)
    assert first == second
    assert ElementTree.fromstring(first).tag.endswith("svg")
    pages = draw_line_pdf(drawing)
    assert pages == draw_line_pdf(drawing)
    assert pages.startswith(b"%PDF")


def test_plan_view_shows_arms_to_their_hinges(staggered: tuple[DiscretisedLine, Geometry]) -> None:
    """The hinge of an arm of more than a metre lies far outside the stagger of the wires."""
    line, geometry = staggered
    drawing = LineDrawing(line, "Line", geometry)
    for row in drawing.rows:
        bottom, top = drawing.extent("y", row)
        hinges = [hinge for _, _, hinge in drawing.arms(row)]
        assert hinges
        assert bottom < min(hinges)
        assert max(hinges) < top
