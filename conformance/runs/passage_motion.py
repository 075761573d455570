"""Moving pictures of a simulated line, coded within a bound of their size."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import LineShape
from pantocheck.conformance.core.step_log import ShareCallback, ignore_progress
from pantocheck.conformance.line.line_shape import LineView
from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.motion_format import (
    CodedField,
    MovingPantograph,
    MovingWire,
    PassageMotion,
    code_field,
)
from pantocheck.conformance.runs.case_run import build_passage, integrate_passage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.passage import FrameRequest, Frames

FRAMES_PER_S = 100.0
"""Frames per second of the simulation: five in a period of 20 Hz."""

SMALLEST_SPACING_M = 0.45
"""Smallest distance of two stations of a frame."""

MOST_LETTERS = 400_000
"""Largest size of a coded picture."""

BAND_RATE_HZ = 250.0
"""Least rate of the part of the force in the extended band."""


Samples = NDArray[np.intp]


@dataclass(frozen=True)
class DrawnStretch:
    """Drawn part of a line, and the instants of its picture."""

    wires: tuple[tuple[int, int], ...]
    """Curve of the shape of the line, and row of the mesh, of each wire."""
    ends: tuple[tuple[float, float], ...]
    """Ends of each wire [m]."""
    request: FrameRequest


@dataclass(frozen=True)
class CodedForm:
    """Form of a coded picture."""

    step_mm: float
    """Step of the rises."""
    nth_frame: int
    nth_station: int
    """Every n-th frame and station is kept."""


@dataclass(frozen=True)
class CodedLine:
    """Coded wires and droppers of a moving picture."""

    wires: list[MovingWire]
    dropper_m: list[float]
    slack: CodedField | None
    error_mm: float


CODED_FORMS = tuple(
    CodedForm(*form)
    for form in (
        *((0.1, 1, 2), (0.2, 1, 2), (0.5, 1, 2), (0.5, 1, 3)),
        *((1.0, 1, 3), (1.0, 1, 4), (1.0, 2, 4), (1.0, 2, 8)),
    )
)
"""Forms of a picture: the first one that is small enough is taken."""


def build_passage_motion(
    case: Case,
    line: DiscretisedLine,
    shape: LineShape,
    discretisation: Discretisation,
    record: Record,
    uplift_forces: tuple[float, ...],
    progress: ShareCallback = ignore_progress,
) -> PassageMotion | None:
    """Moving picture of a passage while the train is on the drawn line, for which it is simulated once more.

    Args:
        case: Case with a speed.
        line: Line of the case, discretised with the element length of `discretisation`.
        shape: Shape of the line at rest.
        discretisation: Element length and time step.
        record: Record of the passage.
        uplift_forces: Uplift force of every pantograph [N].
        progress: Called from time to time with the completed share; its exception ends the work.

    Returns:
        Picture; None if another program moves a pantograph, or if no form is small enough.
    """
    stretch = plan_frames(case, line, shape, discretisation)
    if stretch is None:
        return None
    passage = build_passage(case, line, discretisation, uplift_forces)
    frames = integrate_passage(line, replace(passage, frames=stretch.request, watched=()), progress).frames
    return None if frames is None else code_frames(case, line, stretch, frames, record, progress)


def plan_frames(
    case: Case, line: DiscretisedLine, shape: LineShape, discretisation: Discretisation
) -> DrawnStretch | None:
    """Choose stretch and frames of a picture; None if another program moves a pantograph, or if no frame remains."""
    time_step = discretisation.time_step_s
    steps = _choose_steps(case, time_step, round((case.end - case.start) / case.speed / time_step))
    return None if case.fmus or not steps else choose_stretch(line, shape, steps)


def code_frames(
    case: Case,
    line: DiscretisedLine,
    stretch: DrawnStretch,
    frames: Frames,
    record: Record,
    progress: ShareCallback = ignore_progress,
) -> PassageMotion | None:
    """Code the frames of a passage beside its record; None: no form is small enough."""
    signals, at = RecordSignals(record, case.file.filter).pantographs, np.array(stretch.request.steps) - 1

    def code(form: CodedForm) -> PassageMotion:
        progress(1.0)
        return _code_motion(case, line, stretch, frames, signals, record, at, form)

    return take_small_form(code)


def take_small_form(code_motion: Callable[[CodedForm], PassageMotion]) -> PassageMotion | None:
    """Take the first form whose picture is small enough; None: every form is too large."""
    motions = map(code_motion, CODED_FORMS)
    return next((motion for motion in motions if len(motion.model_dump_json()) <= MOST_LETTERS), None)


def choose_stretch(line: DiscretisedLine, shape: LineShape, steps: Sequence[int]) -> DrawnStretch:
    """Wires and stations of the drawn line, and the completed steps of its frames."""
    first, last = shape.supports_m[0], shape.supports_m[-1]
    views = [(wire, x) for wire, x, _ in LineView(line, "z", first, last).wires() if x.size > 1]
    position = line.mesh.position
    inside = np.flatnonzero((position >= first - SMALLEST_SPACING_M) & (position <= last + SMALLEST_SPACING_M))
    kept = [int(inside[0])]
    for station in inside[1:]:
        if position[station] - position[kept[-1]] >= SMALLEST_SPACING_M:
            kept.append(int(station))
    rows = [line.mesh.row_of[wire.name, "z"] for wire, _ in views]
    request = FrameRequest(tuple(steps), tuple(rows), tuple(kept))
    ends = tuple((float(x[0]), float(x[-1])) for _, x in views)
    return DrawnStretch(tuple(enumerate(rows)), ends, request)


def _choose_steps(case: Case, time_step: float, steps: int) -> range:
    """Steps during which a pantograph is in the analysis section or near it."""
    (start, end), margin = case.analysis_section, case.line.geometry.longest_span / 2
    begin = max((start - margin - max(case.start_positions)) / case.speed, 0.0)
    finish = (end + margin - min(case.start_positions)) / case.speed
    return space_frames(max(round(begin / time_step), 1), min(round(finish / time_step), steps), time_step)


def space_frames(first: int, last: int, time_step: float) -> range:
    """Steps of the frames between two steps."""
    return range(first, last + 1, max(1, round(1 / (FRAMES_PER_S * time_step))))


def _code_motion(
    case: Case,
    line: DiscretisedLine,
    stretch: DrawnStretch,
    frames: Frames,
    signals: dict[int, PantographSignals],
    record: Record,
    at: Samples,
    form: CodedForm,
) -> PassageMotion:
    """Code a picture in one form; `at` are the samples of the record at the frames."""
    coded, time, nth_frame = code_line(line, stretch, frames, form), record.time[at], form.nth_frame
    return PassageMotion(
        start_s=round(float(time[0]), 6),
        step_s=round(float(nth_frame * (time[1] - time[0])), 9),
        speed_m_s=case.speed,
        pantographs=[
            code_pantograph(
                number,
                part,
                record,
                at[::nth_frame],
                *_list_masses(case, record, at[::nth_frame], frames.unknowns[::nth_frame, number - 1], number),
            )
            for number, part in signals.items()
        ],
        **vars(coded),
    )


def code_line(line: DiscretisedLine, stretch: DrawnStretch, frames: Frames, form: CodedForm) -> CodedLine:
    """Code the wires and droppers of a picture in one form."""
    nth_frame = form.nth_frame
    x = line.mesh.position[list(stretch.request.stations)]
    wires, errors = [], []
    for (curve, _), (start, end), rise in zip(
        stretch.wires, stretch.ends, np.moveaxis(frames.displacement, 1, 0), strict=True
    ):
        inside = np.flatnonzero((x >= start - 1e-6) & (x <= end + 1e-6))
        wire, error = code_wire(curve, x[inside], rise[:, inside], form)
        wires.append(wire)
        errors.append(error)
    dropper = np.flatnonzero(line.connectors.unilateral)
    place = line.mesh.position[line.connectors.station[dropper]]
    dropper = dropper[(place >= x[0]) & (place <= x[-1])]
    slack = (frames.tension[::nth_frame, dropper] == 0).astype(np.float64)
    return CodedLine(
        wires=wires,
        dropper_m=[round(float(p), 2) for p in line.mesh.position[line.connectors.station[dropper]]],
        slack=code_field(slack, 1.0) if dropper.size else None,
        error_mm=float(f"{max(errors):.2g}"),
    )


def code_wire(curve: int, x: RealArray, rise: RealArray, form: CodedForm) -> tuple[MovingWire, float]:
    """Code the rises of a wire, (frames, points) [m], in one form; and the error of the coding [mm]."""
    last = x.size - 1
    chosen = np.union1d(np.arange(0, x.size, form.nth_station), [last])
    field = code_field(1e3 * rise[:: form.nth_frame, chosen], form.step_mm)
    along = np.array([np.interp(x, x[chosen], row) for row in field.decode()])
    error = float(np.nanmax(np.abs(along - 1e3 * rise[:: form.nth_frame]), initial=0.0))
    return MovingWire(curve=curve, x_m=[round(float(p), 3) for p in x[chosen]], rise_mm=field), error


def _list_masses(
    case: Case, record: Record, at: Samples, unknowns: RealArray, number: int
) -> tuple[Sequence[str], RealArray]:
    """Names and heights [m] of the masses of a chain; of another pantograph, the head."""
    chain = case.pantographs[number - 1].chain
    if chain is not None:
        names = chain.names or [f"mass {n}" for n, _ in enumerate(chain.masses_kg, 1)]
        return names, unknowns[:, : len(chain.masses_kg)]
    return (), unknowns[:, :1] if record.contact_height is None else record.contact_height[number - 1, at][:, None]


def code_pantograph(
    number: int, signals: PantographSignals, record: Record, at: Samples, names: Sequence[str], heights: RealArray
) -> MovingPantograph:
    """Masses with their heights [m] and forces of a pantograph at the samples of the record of the frames."""
    row = number - 1
    try:
        band = signals.band_part(EXTENDED_BAND.low, EXTENDED_BAND.high)
    except QuantityUnavailable:
        band = np.zeros(0)
    nth = max(1, int(record.rate / BAND_RATE_HZ))
    first = int(np.searchsorted(record.position[row], record.evaluated[0]))
    return MovingPantograph(
        start_m=round(float(record.position[row, at[0]]), 4),
        masses=list(names),
        height_mm=code_field(1e3 * heights, 0.1),
        force_N=code_field(signals.force.graded[at][:, None], 0.05),
        band_N=code_field(band[::nth, None], 0.01) if band.size else None,
        band_start_s=round(float(record.time[first]), 6),
        band_step_s=round(nth / record.rate, 9),
    )
