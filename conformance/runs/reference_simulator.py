"""Reference simulator as a system under test, in the same process."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.start_and_section import list_other_starts
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.figure_data import DrawnCurve, DrawnDroppers, DrawnPoint, DrawnView, LineShape
from pantocheck.conformance.core.step_log import ShareCallback, StepSequence, ignore_progress
from pantocheck.conformance.line.line_discretisation import discretise_line
from pantocheck.conformance.line.line_drawing import find_deflection, list_connections, list_element_marks
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs.case_run import run_passage, run_starts
from pantocheck.conformance.runs.resolution import list_model_uncertainty, resolution_warnings, window_warnings
from pantocheck.conformance.runs.static_quantities import compute_quantities_along_line, compute_static_quantities
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import DiscretisedLine
from pantocheck.model.description.failures import SimulationError

# Drawing of the spans around the analysis section, as curves and points for results.json.
MOST_DRAWN_SPANS = 24
"""Largest number of spans that are drawn: a span is then 6 mm long on paper."""

THINNING_M = 0.0005
"""Largest distance of a wire from its drawn polygon per drawn span [m]: the more spans, the narrower is each of them.

At most 12 mm; a drawing of 2 m height has 28 mm per typographic point."""


@dataclass(frozen=True)
class _Window:
    """Number of spans of a line between two positions [m]."""

    line: DiscretisedLine
    spans: int
    start: float
    end: float

    def contains(self, position: float) -> bool:
        return self.start - 1e-6 <= position <= self.end + 1e-6


def build_line_shape(case: Case, line: DiscretisedLine) -> LineShape:
    """Shape of a line at rest over the spans of the analysis section and one span on either side.

    Args:
        case: Case of the line.
        line: Line at rest.
    """
    geometry, (first, last) = case.line.geometry, case.analysed_spans
    first = max(first - 1, 1)
    last = min(last + 1, geometry.spans, first + MOST_DRAWN_SPANS - 1)
    window = _Window(line, last - first + 1, *geometry.section(first, last))
    return LineShape(
        title=case.line.title,
        first_span=first,
        last_span=last,
        supports_m=[round(x, 2) for x in geometry.span_limits if window.contains(x)],
        side=_build_view(window, "z"),
        plan=_build_view(window, "y") if line.catenary.has_lateral_field else None,
    )


def _build_view(window: _Window, field: str) -> DrawnView:
    line = window.line
    connections = [part for part in list_connections(line.catenary) if window.contains(part.position)]
    return DrawnView(
        curves=list(_list_curves(window, field)),
        droppers=DrawnDroppers(
            x_m=[round(part.position, 2) for part in connections],
            lower_m=[_deflection(window, part.lower, field, part.position) for part in connections],
            upper_m=[_deflection(window, part.upper, field, part.position) for part in connections],
        ),
        points=list(_list_points(window, field)),
    )


def _list_curves(window: _Window, field: str) -> Iterator[DrawnCurve]:
    for wire in window.line.catenary.wires:
        start, end = max(wire.start, window.start), min(wire.end, window.end)
        position = window.line.mesh.position
        x = position[(position >= start - 1e-6) & (position <= end + 1e-6)]
        if x.size > 1:
            w = find_deflection(window.line, wire.name, field, x)
            kept = thin_curve(x, w, window.spans * THINNING_M)
            yield DrawnCurve(
                kind=wire.kind.value,
                x_m=[round(float(value), 2) for value in x[kept]],
                y_m=[round(float(value), 3) for value in w[kept]],
            )


def _list_points(window: _Window, field: str) -> Iterator[DrawnPoint]:
    for mark in list_element_marks(window.line.catenary):
        if window.contains(mark.position):
            y = _deflection(window, mark.wire, field, mark.position)
            yield DrawnPoint(symbol=mark.symbol, x_m=round(mark.position, 2), y_m=y, text=mark.text)


def _deflection(window: _Window, wire: str, field: str, position: float) -> float:
    return round(float(find_deflection(window.line, wire, field, position)), 3)


def thin_curve(x: RealArray, y: RealArray, tolerance: float) -> RealArray:
    """Indices of the corners of a polygon that leaves a curve by no more than a tolerance (Douglas and Peucker, 1973).

    Args:
        x, y: Points of the curve, with rising x.
        tolerance: Largest difference in y.
    """
    kept, parts = {0, x.size - 1}, [(0, x.size - 1)]
    while parts:
        start, end = parts.pop()
        chord = np.interp(x[start : end + 1], x[[start, end]], y[[start, end]])
        distance = np.abs(y[start : end + 1] - chord)
        corner = start + int(distance.argmax())
        if distance.max() > tolerance:
            kept.add(corner)
            parts += [(start, corner), (corner, end)]
    return np.array(sorted(kept))


_LOGGER = logging.getLogger(__name__)

OWN_MESH, FINE_MESH, COARSE_MESH = "mesh of the case", "mesh halved", "mesh doubled"
"""Steps of a case."""


@dataclass(frozen=True)
class ReferenceSimulator:
    """System that runs a case and, for its uncertainty, the case on two other meshes and from other starts."""

    name: str = "Pantocheck reference simulator"
    version: str = version("pantocheck")
    kind: Literal["builtin"] = "builtin"

    def __post_init__(self) -> None:
        """Require the compiler of the time steps at once: later, each case would end as `error`."""
        require_package("numba", "reference simulator")

    def run(self, case: Case) -> Delivered:
        """Run a case, with element length and time step halved and doubled, and from other starts."""
        discretisation, steps = case.file.discretisation, _plan_steps(case)
        delivered, uplift_forces = _deliver(case, discretisation, progress=steps.begin(OWN_MESH))
        shape = build_line_shape(case, discretise_line(case.line, discretisation.element_m))
        refined, _ = _deliver(case, discretisation.scale(1 / 2), uplift_forces, steps.begin(FINE_MESH))
        try:
            coarse, _ = _deliver(case, discretisation.scale(2), uplift_forces, steps.begin(COARSE_MESH))
        except SimulationError:  # too coarse to converge: the uncertainty follows from two meshes
            coarse = None
        starts = () if uplift_forces is None else _run_other_starts(case, discretisation, uplift_forces, steps)
        return replace(delivered, refined=refined, coarse=coarse, starts=starts, line_shape=shape)

    def run_unrefined(self, case: Case) -> Delivered:
        """Run a case once, with the discretisation of the case."""
        steps = StepSequence(_LOGGER, case.id, {OWN_MESH: 1.0})
        return _deliver(case, case.file.discretisation, progress=steps.begin(OWN_MESH))[0]


@dataclass(frozen=True)
class UnrefinedSimulator(ReferenceSimulator):
    """Reference simulator that runs a case once: the uncertainty of discretisation stays unknown."""

    def run(self, case: Case) -> Delivered:
        """Run a case once, with the discretisation of the case."""
        return self.run_unrefined(case)


def _plan_steps(case: Case) -> StepSequence:
    """Steps of a case, with their estimated durations in passages on the mesh of the case."""
    other_starts = () if case.is_static else list_other_starts(case)
    starts = {f"start {number}": 1.0 for number, _ in enumerate(other_starts, 1)}
    return StepSequence(_LOGGER, case.id, {OWN_MESH: 2.0, FINE_MESH: 4.0, COARSE_MESH: 0.25, **starts})


def _run_other_starts(
    case: Case, discretisation: Discretisation, uplift_forces: tuple[float, ...], steps: StepSequence
) -> tuple[Delivered, ...]:
    """Simulate a case from other starts, if its run-in is short."""
    starts = list_other_starts(case)
    if not starts:
        return ()
    line = discretise_line(case.line, discretisation.element_m)
    runs = run_starts(starts, case, line, discretisation, uplift_forces)
    delivered = []
    for number, _ in enumerate(starts, 1):
        steps.begin(f"start {number}")
        delivered.append(Delivered(next(runs)))
    return tuple(delivered)


def _deliver(
    case: Case,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...] | None = None,
    progress: ShareCallback = ignore_progress,
) -> tuple[Delivered, tuple[float, ...] | None]:
    """Simulate a case; result, and uplift forces of its passage [N]."""
    line = discretise_line(case.line, discretisation.element_m)
    static = compute_static_quantities(case, line)
    if case.is_static:
        static |= compute_quantities_along_line(case.line, line)
        return Delivered(
            static=static, run=RunTable(dt_s=discretisation.time_step_s, element_m=discretisation.element_m)
        ), None
    passage = run_passage(case, line, discretisation, uplift_forces, progress)
    delivered = Delivered(
        passage.record,
        static,
        passage.run,
        warnings=(*resolution_warnings(case, discretisation), *window_warnings(case, line, discretisation)),
        model_uncertainty=list_model_uncertainty(case),
        start=case.start_table,
        uplift_forces=passage.uplift_forces,
    )
    return delivered, passage.uplift_forces
