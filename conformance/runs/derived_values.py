"""Derived values of a case: the conventions of its equations as numbers, sent to programs beside the inputs.

Lists follow the order of the line: parts of parallel wires follow each other at one position, wire 1 first. Lists of
droppers have one list per span. Values of arms and supports are one number if they are all equal, and else a list.
"""

from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.sourced_table import InputTable, is_absent
from pantocheck.conformance.line.catenary_model import DerivedLine, build_catenary, build_derived_line
from pantocheck.conformance.line.elements.derived_numbers import Numbers, round_number, round_numbers, round_positions
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.records.sidecar_tables import StartTable
from pantocheck.conformance.runs.case_run import list_start_forces
from pantocheck.conformance.runs.uplift_tuning import (
    TOLERANCE,
    build_pantographs,
    compute_working_height,
    working_height_positions,
)
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.statics.contact_wires import touched_rows
from pantocheck.model.statics.elasticity import height_under_forces


class DerivedPantograph(InputTable):
    """Pantograph at the start: M z'' + C z' + K z = constant_force - contact force on the head.

    z counts upwards from the zero of all heights; its unknowns are the masses of a chain from base to head, the degrees
    of freedom of the matrices, or the modes.
    """

    uplift_force_N: float
    """Uplift force for which this table holds [N]; with target_mean_force_N: start of the tuning."""
    working_height_m: float
    """Static height of the head under the uplift force: mean uplift of the contact wire over
    working_height_positions_m, plus its nominal height, plus the penetration of the contact [m].
    """
    constant_force: Numbers
    """Constant force on every unknown: uplift force, and force of the springs at z = 0 [N; modes: N kg^-1/2]."""
    contact_stiffness_N_m: float | None
    """Contact force = max(0, stiffness (height of the head - height of the wire)) [N/m]; null: the table contact of the
    inputs states another law.
    """
    contact_force_share: float
    """Share of every contact wire at the start [-]."""
    start_m: float
    """Position at the start [m]."""
    start_force_N: float
    """Contact force at the start [N]."""
    start_wire_height_m: float
    """Height of the contact wire at the position of the head at the start [m]."""
    start_strip_force_N: Annotated[Numbers | None, Field(exclude_if=is_absent)] = None
    """Contact force of each of several strips at the start; their sum is start_force_N [N]."""
    start_strip_wire_height_m: Annotated[Numbers | None, Field(exclude_if=is_absent)] = None
    """Height of the contact wire above each of several strips at the start [m]."""
    start_displacement: Numbers
    """z of every unknown at the start [m; modes: m kg^1/2]; behind those of the model pitch, strips on springs, roll
    and bending modes.
    """


class DerivedStart(StartTable):
    """Start of the run, and its motion from the time 0 on."""

    speed_m_s: float
    """Speed of the train from the time 0 on [m/s]."""
    line_velocity_m_s: float = 0.0
    """Velocity of every point of line and pantographs [m/s]."""
    duration_s: float
    """Simulated time [s]."""


class DerivedEvaluation(InputTable):
    """Conventions of the quantities. Mean, bands and contact loss use the unfiltered force."""

    time_step_s: float
    """Time step of the reference simulator, and time of its first sample [s]."""
    section_m: tuple[float, float]
    """Analysis section [m]: samples at start <= position < end of their own pantograph."""
    bands_Hz: Annotated[tuple[tuple[float, float], ...], Field(strict=False)]
    """Bands ]low, high] of the amplitude spectrum of the section, without window [Hz]."""
    filter_passes: int
    """Passes of the filter over the whole record, 2: forwards and back."""
    filter_pass_order: int
    """Order of the Butterworth filter of a single pass."""
    filter_pass_cutoff_Hz: float
    """-3 dB frequency of a single pass at 1 / time_step_s, by the bilinear transform [Hz]."""
    std_degrees_of_freedom: int = 0
    """Subtracted from the number of samples in the standard deviation."""
    tuned_mean_tolerance_N: float
    """Largest difference of a tuned mean contact force from target_mean_force_N [N]."""


class DerivedTrain(InputTable):
    """Train of the case: pantographs, start and evaluation."""

    pantographs: tuple[DerivedPantograph, ...]
    """Pantographs in running order."""
    working_height_positions_m: Numbers
    """Positions of the mean uplift: the first span of the analysis section, without its end [m]."""
    start: DerivedStart
    evaluation: DerivedEvaluation


class Derived(InputTable):
    """Values that follow from the inputs of a case by the conventions of docs/systems.md, to six digits."""

    line: DerivedLine
    train: DerivedTrain | None
    """null: check of the line at rest."""


# Computation of the values.
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
    return DerivedTrain(
        pantographs=_pantographs(case, line),
        working_height_positions_m=round_positions(working_height_positions(case)),
        start=build_derived_start(case),
        evaluation=_evaluation(case),
    )


def _pantographs(case: Case, line: DiscretisedLine) -> tuple[DerivedPantograph, ...]:
    models = build_pantographs(case, line, list_start_forces(case))
    places = [
        np.array([start + strip.offset for strip in model.strips])
        for model, start in zip(models, case.start_positions, strict=True)
    ]
    forces = [model.static_force * model.strip_shares for model in models]
    heights = iter(height_under_forces(line, np.concatenate(places), np.concatenate(forces)).tolist())
    pantographs = []
    parts = zip(case.pantographs, case.lift_forces, case.start_positions, models, forces, strict=True)
    for file, lift, start, model, strip_forces in parts:
        force = lift.uplift_force
        share = 1 / touched_rows(line, start).size
        working_height = compute_working_height(case, line, file, force)
        height = np.array([next(heights) for _ in strip_forces])
        displacement, _ = equilibrium(model, height + file.contact.penetration(strip_forces * share))
        several = height.size > 1
        pantographs.append(
            DerivedPantograph(
                uplift_force_N=force,
                working_height_m=round_number(working_height),
                constant_force=round_numbers(model.force),
                contact_stiffness_N_m=file.contact.stiffness_N_m,
                contact_force_share=share,
                start_m=start,
                start_force_N=force,
                start_wire_height_m=round_number(float(height.mean())),
                start_strip_force_N=round_numbers(strip_forces) if several else None,
                start_strip_wire_height_m=round_numbers(height) if several else None,
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
