"""Derived values of a case: its line at rest, and its train at the start; `derived_format` defines them."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.derived_line import build_derived_line
from pantocheck.conformance.line.elements.derived_numbers import round_number, round_numbers, round_positions
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.runs.case_run import start_forces
from pantocheck.conformance.runs.derived_format import (
    Derived,
    DerivedEvaluation,
    DerivedPantograph,
    DerivedStart,
    DerivedTrain,
)
from pantocheck.conformance.runs.uplift_tuning import (
    TOLERANCE,
    compute_working_height,
    nominal_wire_height,
    working_height_positions,
)
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.statics.contact_wires import touched_rows
from pantocheck.model.statics.elasticity import height_under_forces

ELEMENT_M = 0.125
"""Element length for the derived values [m]; lengths are converged to 0.02 mm, dropper forces to 0.005 N."""


def build_derived(case: Case) -> Derived:
    """Derived values of a case.

    Args:
        case: Case with or without a train.

    Returns:
        Values of the line and, with a speed, of the train.

    Raises:
        NoInitialState: The prescribed geometry of the line has no equilibrium.
        NoEquilibrium: The line has no equilibrium under the uplift forces.
    """
    line = discretise(build_catenary(case.line), ELEMENT_M)
    train = None if case.is_static else _train(case, line)
    return Derived(line=build_derived_line(case.line, line), train=train)


def build_derived_start(case: Case) -> DerivedStart:
    """Start of the run of a case with a speed."""
    return DerivedStart(
        **case.start_table.model_dump(),
        speed_m_s=round_number(case.speed),
        duration_s=round_number((case.end - case.start) / case.speed),
    )


def _train(case: Case, line: DiscretisedLine) -> DerivedTrain:
    heights = height_under_forces(line, np.array(case.start_positions), np.array(start_forces(case)))
    return DerivedTrain(
        pantographs=_pantographs(case, line, heights),
        working_height_positions_m=round_positions(working_height_positions(case)),
        start=build_derived_start(case),
        evaluation=_evaluation(case),
    )


def _pantographs(case: Case, line: DiscretisedLine, heights: RealArray) -> tuple[DerivedPantograph, ...]:
    pantographs = []
    for file, lift, start, height in zip(
        case.pantographs, case.lift_forces, case.start_positions, heights, strict=True
    ):
        force = lift.uplift_force
        contact, share = file.contact.stiffness_N_m, 1 / touched_rows(line, start).size
        working_height = compute_working_height(case, line, file, force)
        model = build_pantograph(file, force, working_height, nominal_wire_height(case), lift.aerodynamic_force)
        displacement, _ = equilibrium(model, float(height) + force * share / contact)
        pantographs.append(
            DerivedPantograph(
                uplift_force_N=force,
                working_height_m=round_number(working_height),
                constant_force=round_numbers(model.force),
                contact_stiffness_N_m=contact,
                contact_force_share=share,
                start_m=start,
                start_force_N=force,
                start_wire_height_m=round_number(height),
                start_displacement=round_numbers(displacement),
            )
        )
    return tuple(pantographs)


def _evaluation(case: Case) -> DerivedEvaluation:
    step, low_pass = case.file.discretisation.time_step_s, case.file.filter
    order, cutoff = low_pass.single_run(1 / step)
    return DerivedEvaluation(
        time_step_s=step,
        section_m=case.analysis_section,
        bands_Hz=tuple((float(band.low), float(band.high)) for band in BANDS),
        filter_passes=low_pass.runs,
        filter_pass_order=order,
        filter_pass_cutoff_Hz=round_number(cutoff),
        tuned_mean_tolerance_N=TOLERANCE,
    )
