"""Lines and passages of the evidence: AC simple of EN 50318:2018 at 320 km/h with any number of spans."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.model import Catenary, DiscretisedLine, History, Passage
from pantocheck.model.discretisation.connectors import arm_direction
from pantocheck.model.discretisation.initial_state import InitialState

QUANTITIES = (
    "std_force_N",
    "rms_0_5_N",
    "rms_5_20_N",
    "rms_20_50_N",
    "max_force_N",
    "min_force_N",
    "max_uplift_at_support_mm",
)
ALLOWED_PCT = dict(zip(QUANTITIES, (1.0, 1.0, 1.0, 2.0, 1.0, 3.0, 1.0), strict=True))
"""Target of the error at the default mesh by quantity: 20-50 Hz and the smallest force depend on short waves."""
UPLIFT_FORCE = 172.7
"""Constant uplift force, which gives a mean contact force of about 169 N [N]."""
SPACING = 200.0
"""Distance between two pantographs [m]."""


def ac_simple(spans: int, stagger: float = 0.2, case: str = "en50318-2018/ac-simple/320") -> Case:
    """Case of AC simple with another number of spans and another stagger [m]."""
    selected = next(candidate for candidate in select_cases([case]) if candidate.id == case)
    geometry = selected.line.geometry.model_copy(update={"spans": spans, "stagger_contact_wire_m": stagger})
    return replace(selected, line=selected.line.model_copy(update={"geometry": geometry}))


def staggered(case: Case) -> Catenary:
    """The line of a case."""
    return build_catenary(case.line)


def vertical(case: Case, state: InitialState) -> Catenary:
    """Line of a case in the vertical plane; each arm has the stiffness of its axial force under the stagger.

    Args:
        case: Case with stagger.
        state: Initial state of the line with stagger, which gives the axial forces.
    """
    built = build_catenary(case.line)
    arms = tuple(
        replace(arm, vertical_stiffness=arm_direction(arm, force)[2] / (arm.length or 1.0))
        for arm, force in zip(built.steady_arms, state.arm_force, strict=True)
    )
    wires = tuple(replace(wire, stagger=None) for wire in built.wires)
    return replace(built, wires=wires, steady_arms=arms)


def passage(
    case: Case,
    line: DiscretisedLine,
    step: float,
    pantographs: int,
    until: float,
    reach: float,
) -> Passage:
    """Passage of pantographs from the end of the first span to a position.

    Args:
        case: Gives speed and pantograph.
        line: Discretised line.
        step: Time step [s].
        pantographs: Number of pantographs, 1 or 2.
        until: Final position of the last pantograph [m].
        reach: Half-width of the active window around the pantographs [m].
    """
    geometry = case.line.geometry
    first = geometry.span(1)[1]
    model = build_pantograph(case.pantographs[0], UPLIFT_FORCE, 0.06)
    starts = tuple(first + SPACING * (pantographs - 1 - i) for i in range(pantographs))
    return Passage(
        pantographs=(model,) * pantographs,
        start=starts,
        speed=case.speed,
        duration=(until - first) / case.speed,
        time_step=step,
        watched=tuple(("contact wire", x) for x in geometry.supports),
        reach=reach,
    )


def figures(way: Passage, history: History, evaluated: tuple[float, float], pantograph: int = 1) -> dict[str, float]:
    """Quantities of a pantograph (1 leads) and of the line over an analysis section [m]."""
    record = Record(
        time=history.time,
        speed=way.speed,
        position=history.position,
        force=history.force,
        evaluated=evaluated,
        support_position=np.array([x for _, x in way.watched]),
        support_uplift=history.motion[:, :, 0],
    )
    supports = tuple(x for _, x in way.watched)
    values = evaluate_record(record, Filter(), supports).values
    return {name: float({**values[0], **values[pantograph]}[name]) for name in QUANTITIES}
