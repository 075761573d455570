"""Scenarios of Table 1 of Vo Van, Balmes and Lorang (2015): line, speed, pantograph and spacing, and their runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import ComponentDamping, Damping
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.studies.vovan2015.damping_change import ForceChanges, compare_damping_runs
from pantocheck.model import discretise
from pantocheck.model.description.failures import SimulationError

MEAN_FORCES = (151.0, 210.0)
"""Mean contact forces of front and rear, which follow from the printed values [N]."""
LARGEST_DEVIATION_N = 1.0
"""Deviation of a mean contact force above which the uplift forces are corrected, once: 0.7 % of the mean force."""
HEAD_RISE_M = 0.06
"""First guess of the mean rise of a head above its working height, which the base spring feels [m]."""
RUN_IN_SPANS, EVALUATED_SPANS, RUN_OUT_SPANS = 15, 10, 8
SETTLED_RUN_IN_SPANS, SHIFTED_SPANS = 36, 10
COARSE = {"element_m": 1.0, "time_step_s": 0.002}
"""Mesh and time step of the search, twice those of the case. They add 4 points to the change of the front pantograph in
20-50 Hz, and change every other one by at most 1.2 points."""
LARGEST_DROPPER_DISTANCE_M = 7.0
"""Largest distance of neighbouring droppers: 6.75 m in the assumed line."""
FIRST_DROPPER_M = 4.5
"""Distance of the outer droppers from the supports [m], as in the assumed line and in AC simple."""
TENSIONS_N = {"20/14": (20e3, 14e3), "20/16": (20e3, 16e3), "22/16": (22e3, 16e3)}
"""Tension of contact and messenger wire: the assumed line, EN 50318:2002, AC simple of EN 50318:2018."""
PANTOGRAPHS = {
    "EN 50318:2018": "en50318-2018/pantograph.toml",
    "DSA250": "pantographs/dsa250.toml",
    "DSA380": "pantographs/dsa380.toml",
}


class Scenario(NamedTuple):
    """Line, speed and pantographs of a passage; without a spacing the front pantograph runs alone.

    The tensions are a key of `TENSIONS_N`, the pre-sag is a share of the span, the droppers have equal distances.
    """

    span_m: float
    tensions: str
    presag_share: float
    speed_km_h: float
    pantograph: str
    spacing_m: float | None = None


CHOSEN = Scenario(54.0, "20/16", 1e-3, 300.0, "EN 50318:2018", 200.0)
"""Scenario of the case: the closest scenario of the search, with the spacing of the rule for 250 km/h and more."""


@dataclass(frozen=True)
class InitialRun:
    """Passage of a scenario with the initial damping: quantities, and uplift forces [N]."""

    scenario: Scenario
    values: ValuesByOwner
    uplift_forces: tuple[float, ...]

    @property
    def pantographs(self) -> list[int]:
        """Numbers of the pantographs."""
        return sorted(owner for owner in self.values if owner != LINE)

    @property
    def contact_loss_pct(self) -> float:
        """Largest contact loss of a pantograph [%]."""
        return max(float(self.values[p]["contact_loss_pct"]) for p in self.pantographs)

    @property
    def uplift_mm(self) -> float:
        """Largest uplift at a support [mm]."""
        return float(self.values[LINE]["max_uplift_at_support_mm"])


@cache
def load_study() -> Case:
    """The case of Table 1."""
    return load_case(library_folder() / "vovan2015/contact-force.toml")


def wave_speed(scenario: Scenario) -> float:
    """Speed of transverse waves on the contact wire [m/s]."""
    return float(np.sqrt(TENSIONS_N[scenario.tensions][0] / load_study().line.contact_wire.mass_kg_m))


def build_line(scenario: Scenario, run_in_spans: int = RUN_IN_SPANS) -> LineFile:
    """Line of a scenario: the assumed line with other spans, tensions and droppers, and a parabolic pre-sag."""
    line, span = load_study().line, scenario.span_m
    first, last = FIRST_DROPPER_M, span - FIRST_DROPPER_M
    x = np.linspace(first, last, int(np.ceil((last - first) / LARGEST_DROPPER_DISTANCE_M - 1e-9)) + 1)
    presag = 4 * scenario.presag_share * span * (x - first) * (last - x) / (last - first) ** 2
    spacing_spans = int(np.ceil((scenario.spacing_m or 0.0) / span))
    spans = run_in_spans + EVALUATED_SPANS + spacing_spans + RUN_OUT_SPANS
    contact, messenger = TENSIONS_N[scenario.tensions]
    update = {
        "geometry": line.geometry.model_copy(update={"span_m": span, "spans": spans}),
        "droppers": line.droppers.model_copy(
            update={"x_m": tuple(map(float, x)), "presag_m": tuple(map(float, presag))}
        ),
        "contact_wire": line.contact_wire.model_copy(update={"tension_N": contact}),
        "messenger_wire": line.messenger_wire.model_copy(update={"tension_N": messenger}),
    }
    return line.model_copy(update=update)


def build_case(scenario: Scenario, run_in_spans: int = RUN_IN_SPANS) -> Case:
    """Case of a scenario, with one pantograph or two and without limits."""
    study = load_study()
    count = 1 if scenario.spacing_m is None else 2
    uses = tuple(
        use.model_copy(update={"uplift_force_N": force, "target_mean_force_N": None})
        for use, force in zip(study.file.pantograph, MEAN_FORCES, strict=True)
    )
    update = {
        "pantograph": uses[:count],
        "spacing_m": None if scenario.spacing_m is None else (scenario.spacing_m,),
        "speed_km_h": scenario.speed_km_h,
        "evaluated_spans": (run_in_spans + 1, run_in_spans + EVALUATED_SPANS),
        "compared_spans": None,
        "discretisation": study.file.discretisation.model_copy(update=COARSE),
        "limit": (),
    }
    pantograph = read_model(library_folder() / PANTOGRAPHS[scenario.pantograph], PantographFile, "pantograph")
    return replace(
        study,
        file=study.file.model_copy(update=update),
        line=build_line(scenario, run_in_spans),
        pantographs=(pantograph,) * count,
        limits=(),
    )


CaseChange = Callable[[Case], Case]
"""Change of the case of a scenario: its initial damping or its pantographs."""


def keep_case(case: Case) -> Case:
    """The case itself: no change."""
    return case


def change_initial_damping(**parts: tuple[float, float]) -> CaseChange:
    """Initial damping with other coefficients of some kinds of component, by their keys in a damping file [1/s, s]."""
    tables = {
        key: ComponentDamping(mass_coefficient_1_s=mass, stiffness_coefficient_s=stiffness)
        for key, (mass, stiffness) in parts.items()
    }
    return lambda case: replace(
        case, dampings={name: damping.model_copy(update=tables) for name, damping in case.dampings.items()}
    )


def change_contact(stiffness_N_m: float) -> CaseChange:
    """Contact spring of every pantograph with another stiffness [N/m]."""
    return _change_pantographs(
        lambda file: file.model_copy(
            update={"contact": file.contact.model_copy(update={"stiffness_N_m": stiffness_N_m})}
        )
    )


def change_head(share: float) -> CaseChange:
    """Head of every pantograph, the last mass of its chain, times a factor [-]."""

    def change_mass(file: PantographFile) -> PantographFile:
        assert file.chain is not None
        masses = (*file.chain.masses_kg[:-1], share * file.chain.masses_kg[-1])
        return file.model_copy(update={"chain": file.chain.model_copy(update={"masses_kg": masses})})

    return _change_pantographs(change_mass)


def _change_pantographs(change: Callable[[PantographFile], PantographFile]) -> CaseChange:
    return lambda case: replace(case, pantographs=tuple(map(change, case.pantographs)))


def run_initial(
    scenario: Scenario, mean_forces: Sequence[float] = MEAN_FORCES, change: CaseChange = keep_case
) -> InitialRun | None:
    """Run a changed scenario with the initial damping; None if it has no initial state or no solution.

    The uplift forces are corrected once, so that the mean contact forces are near the given ones [N].
    """
    case = change(build_case(scenario))
    ((_, initial),) = case.dampings.items()
    targets = np.array(mean_forces[: len(case.pantographs)])
    spring = 0.0 if case.pantographs[0].chain is None else case.pantographs[0].chain.stiffness_N_m[0]
    forces = targets + spring * HEAD_RISE_M
    try:
        values = _simulate(case, initial, forces).evaluation.values
        error = targets - [float(values[p + 1]["mean_force_N"]) for p in range(targets.size)]
        if np.abs(error).max() > LARGEST_DEVIATION_N:
            forces = forces + error
            values = _simulate(case, initial, forces).evaluation.values
    except SimulationError:
        return None
    return InitialRun(scenario, values, tuple(map(float, forces)))


def run_settled_changes(run: InitialRun, change: CaseChange = keep_case) -> ForceChanges:
    """Changes by the updated damping after a long run-in, with the uplift forces of a run, and their spread.

    The analysis section is shifted back by up to `SHIFTED_SPANS` spans.
    """
    case = change(build_case(run.scenario, SETTLED_RUN_IN_SPANS))
    geometry, first = case.line.geometry, SETTLED_RUN_IN_SPANS + 1
    sections = [geometry.section(i, i + EVALUATED_SPANS - 1) for i in range(first - SHIFTED_SPANS, first + 1)]
    ((_, initial),) = case.dampings.items()
    signals = (_simulate(case, damping, run.uplift_forces) for damping in (initial, case.line.damping))
    return compare_damping_runs(*signals, sections)


def _simulate(case: Case, damping: Damping, forces: Sequence[float]) -> RecordSignals:
    """Signals of a passage with another damping and given uplift forces [N]."""
    variant = case.with_damping("other", damping)
    line = discretise(build_catenary(variant.line), variant.file.discretisation.element_m)
    run = run_passage(variant, line, variant.file.discretisation, tuple(map(float, forces)))
    return RecordSignals(run.record, variant.file.filter, variant.line.geometry.supports)
