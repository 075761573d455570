"""Geometrically exact model of a line: masses, unstretched lengths and directions from its static state."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.line.elements.wire import WireTable
from pantocheck.model import DiscretisedLine, Passage, discretise, simulate_passage
from pantocheck.model.description.catenary import GRAVITY, Kind
from verification.formulations.exact_forces import allocate_scratch, build_bars, build_springs, sum_forces
from verification.formulations.exact_line import (
    Array,
    ExactLine,
    Indices,
    Wires,
    hinge_positions,
    no_strings,
    point_number,
    support_points,
    unstretched_lengths,
    wire_positions,
)
from verification.formulations.exact_passage import Rest, find_rest, simulate_exact_passage
from verification.speed.passage_lines import ac_simple, figures, passage, staggered, vertical

AlongTrack = Literal["fixed", "free"]
"""Whether the messenger wire is held along the track at its supports."""


def build_exact_line(
    line: DiscretisedLine, axial_stiffness: dict[str, float], along_track: AlongTrack
) -> tuple[ExactLine, Array]:
    """Build the exact model of a line and the positions of its points in the linear static state.

    Args:
        line: Line with equidistant stations.
        axial_stiffness: EA of each wire by name [N].
        along_track: Support of the messenger wire along the track.

    Returns:
        Line, and positions, (3, N) [m].
    """
    wires = _build_wires(line, axial_stiffness)
    hinges = hinge_positions(line)
    position = np.hstack([wire_positions(line), hinges])
    mass, drag = _masses(line, hinges.shape[1])
    free = np.ones_like(position)
    free[:, wires.first], free[:, wires.last], free[:, position.shape[1] - hinges.shape[1] :] = 0.0, 0.0, 0.0
    supports = support_points(line)
    if along_track == "fixed":
        free[0, supports] = 0.0
    exact = ExactLine(
        mass=mass,
        drag=drag,
        free=free,
        unstretched=unstretched_lengths(position, wires),
        gravity=GRAVITY,
        wires=wires,
        bars=build_bars(line, position),
        springs=build_springs(line, position),
        strings=no_strings(),
    )
    return _carry_reactions(exact, position, supports), position


def _build_wires(line: DiscretisedLine, axial_stiffness: dict[str, float]) -> Wires:
    lengths, wires = np.diff(line.mesh.position), line.catenary.wires
    if np.ptp(lengths) > 1e-6:
        raise ValueError(f"elements of {lengths.min():g} m to {lengths.max():g} m; the exact model needs equal ones")
    first = lengths.size * np.arange(len(wires)) + np.arange(len(wires))
    return Wires(
        first=first,
        last=first + lengths.size,
        axial_stiffness=np.array([axial_stiffness[wire.name] for wire in wires]),
        bending_stiffness=np.array([wire.bending_stiffness for wire in wires]),
        tension=np.array([wire.tension for wire in wires]),
        spacing=np.full(len(wires), lengths.mean()),
        stiffness_coefficient=np.array([line.catenary.rayleigh(w.kind).stiffness_coefficient for w in wires]),
    )


def _masses(line: DiscretisedLine, hinges: int) -> tuple[Array, Array]:
    """Mass [kg] and mass-proportional damping [N s/m] of every point; a hinge has unit mass and is held."""
    stations, wires, h = line.mesh.position.size, line.catenary.wires, np.diff(line.mesh.position).mean()
    mass, drag = np.zeros(len(wires) * stations), np.zeros(len(wires) * stations)
    for n, wire in enumerate(wires):
        share = np.full(stations, h * wire.mass_per_length)
        share[[0, -1]] /= 2
        mass[n * stations : (n + 1) * stations] = share
        drag[n * stations : (n + 1) * stations] = line.catenary.rayleigh(wire.kind).mass_coefficient * share

    def lump(wire: str, x: float, m: float, kind: Kind) -> None:
        mass[point_number(line, wire, x)] += m
        drag[point_number(line, wire, x)] += line.catenary.rayleigh(kind).mass_coefficient * m

    for d in line.catenary.droppers:
        lump(d.upper, d.position, d.mass / 2 + d.upper_clamp_mass, Kind.DROPPER)
        lump(d.lower, d.position, d.mass / 2 + d.lower_clamp_mass, Kind.DROPPER)
    for arm in line.catenary.steady_arms:
        lump(arm.wire, arm.position, arm.mass, Kind.STEADY_ARM)
    return np.append(mass, np.ones(hinges)), np.append(drag, np.zeros(hinges))


def _carry_reactions(line: ExactLine, position: Array, supports: Indices) -> ExactLine:
    """Move the anchors of the supports so that their springs carry the forces of the static state."""
    force = np.zeros_like(position)
    sum_forces(line, position, np.zeros_like(position), force, allocate_scratch(line.mass.size))
    anchor = line.springs.anchor.copy()
    carried = np.isin(line.springs.point, supports) & (line.springs.stiffness > 0)
    anchor[carried] -= force[:, line.springs.point][carried] / line.springs.stiffness[carried]
    return line._replace(springs=line.springs._replace(anchor=anchor))


# AC simple for the geometrically exact model: line, passage and quantities shared by its commands.
REFERENCE_STEP_PER_LENGTH = 2e-3
"""Time step over element length of the reference simulator [s/m]."""
AFTER = 2
"""Spans after the analysis section."""


@dataclass(frozen=True)
class ExactCase:
    """AC simple with one pantograph."""

    case: Case
    """Case with its number of spans and stagger."""
    line: DiscretisedLine
    """Line with equidistant stations."""
    passage: Passage
    """Passage from the end of the first span to the middle of the last but one."""

    @property
    def section(self) -> tuple[int, int]:
        """First and last span of the analysis section: eight spans, or half of a short line."""
        spans = self.case.line.geometry.spans
        return spans - AFTER - min(8, spans // 2) + 1, spans - AFTER

    @property
    def axial_stiffness(self) -> dict[str, float]:
        """EA of both wires as solid round bars [N]."""
        line = self.case.line
        tables = (line.contact_wire, line.messenger_wire)
        return {w.name: axial_stiffness(table) for w, table in zip(self.line.catenary.wires, tables, strict=True)}

    def find_rest(self) -> Rest:
        """Rest of the exact model, with the messenger wire fixed along the track."""
        return find_rest(*build_exact_line(self.line, self.axial_stiffness, "fixed"))

    def release(self, rest: Rest) -> Rest:
        """Release the messenger wire along the track; with equal tension in all spans this moves nothing."""
        free = build_exact_line(self.line, self.axial_stiffness, "free")[0].free
        return replace(rest, line=rest.line._replace(free=free))

    def simulate_exactly(self, rest: Rest) -> dict[str, float]:
        """Quantities of a passage along the exact model."""
        history = simulate_exact_passage(self.line, rest, self.passage)
        return figures(self.passage, history, self.case.line.geometry.section(*self.section))

    def build_reference(self, along_track: AlongTrack) -> DiscretisedLine:
        """Line of the reference simulator with another support of the messenger wire along the track."""
        catenary, stiffness = self.line.catenary, self.axial_stiffness
        supports = tuple(replace(support, along_track=along_track) for support in catenary.messenger_supports)
        wires = tuple(replace(wire, axial_stiffness=stiffness[wire.name]) for wire in catenary.wires)
        catenary = replace(catenary, wires=wires, messenger_supports=supports)
        return discretise(catenary, float(np.diff(self.line.mesh.position).max()))

    def simulate_reference(self, along_track: AlongTrack) -> dict[str, float]:
        """Quantities of the same passage in the reference simulator."""
        history = simulate_passage(self.build_reference(along_track), self.passage)
        return figures(self.passage, history, self.case.line.geometry.section(*self.section))


def build_exact_case(spans: int, element: float, stagger: float) -> ExactCase:
    """AC simple with a number of spans, an element length and a stagger [m].

    Without stagger the line lies in the vertical plane, and each arm is a spring with the vertical stiffness of an arm
    under the stagger of 0.2 m.
    """
    case = ac_simple(spans)
    catenary = staggered(case)
    if stagger == 0.0:
        catenary = vertical(case, discretise(catenary, 0.5).state)
    else:
        case = ac_simple(spans, stagger)
        catenary = staggered(case)
    line, geometry = discretise(catenary, element), case.line.geometry
    until = geometry.mid_span(spans - 1)
    return ExactCase(case, line, passage(case, line, REFERENCE_STEP_PER_LENGTH * element, 1, until, math.inf))


def axial_stiffness(table: WireTable) -> float:
    """Axial stiffness EA of a solid round bar with the bending stiffness and the area of a wire [N].

    With I = A^2 / 4 pi follows EA = 4 pi EI / A.
    """
    if table.area_mm2 is None:
        raise ValueError("the axial stiffness needs the area of the wire; key area_mm2")
    return 4 * math.pi * table.bending_stiffness_N_m2 / (1e-6 * table.area_mm2)


def print_rows(rows: dict[str, dict[str, float]]) -> None:
    """Print quantities in Markdown, one row per model."""
    quantities = list(next(iter(rows.values())))
    print(f"| | {' | '.join(quantities)} |\n| :-- |{' --: |' * len(quantities)}")
    for name, values in rows.items():
        print(f"| {name} | {' | '.join(f'{values[q]:.2f}' for q in quantities)} |", flush=True)


def change_pct(values: dict[str, float], base: dict[str, float]) -> dict[str, float]:
    """Change of every quantity [%]."""
    return {q: 100 * (values[q] / base[q] - 1) for q in values}
