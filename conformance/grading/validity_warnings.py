"""Limits of validity of a run: warnings with the reason and the remedy, for the run of any system."""

import math
from collections.abc import Iterator

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import AppliedForces
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.fem.beam import wave_speed

HIGH_SPEED, CRITICAL_SPEED = 0.7, 0.9
"""Shares of the wave speed of the contact wire above which a run is warned of.

A wave that runs ahead and is reflected returns amplified by (c + v) / (c - v): 6 times at 0.7, the usual limit of
operation, and 19 times at 0.9."""

LARGEST_STATIC_DIFFERENCE = 0.03
"""Relative difference of static contact force and uplift force above which the convention of the working height
matters: the accepted error of the mean force in the consistency check."""


def validity_warnings(case: Case, evaluation: Evaluation) -> list[str]:
    """Warnings on speed, start, working height and lost contact of a passage; none for a static case.

    Args:
        case: Case of the run.
        evaluation: Quantities of the run.
    """
    if case.is_static or not case.pantographs:
        return []
    return [
        *speed_warnings(case),
        *_start_warnings(case),
        *_working_height_warnings(case),
        *_contact_loss_warnings(evaluation),
    ]


def speed_warnings(case: Case) -> Iterator[str]:
    """Warn of a speed near the wave speed sqrt(T / m) of the contact wire, the slowest wave that meets the head.

    Args:
        case: Case of a passage.

    Yields:
        Warning with the reason and the remedy.
    """
    wires = [case.line.section_file(place).contact_wire for place in case.line.section_places]
    c = min(wave_speed(wire.tension_N, wire.mass_kg_m) for wire in wires)
    share = case.speed / c
    speed = (
        f"{3.6 * case.speed:.4g} km/h is {100 * share:.3g} % of the wave speed of the contact wire, {3.6 * c:.4g} km/h"
    )
    if share > CRITICAL_SPEED:
        yield (
            f"speed: {speed}. The waves hardly run ahead of the pantograph: the results depend on run-in, damping, "
            "element and time step, and are no prediction. Choose a higher tension or a lower speed"
        )
    elif share > HIGH_SPEED:
        yield (
            f"speed: {speed}, above the usual limit of {100 * HIGH_SPEED:g} %. The results settle slowly: lengthen the "
            "run-in until a shift of the analysis section (compared_spans) changes no result"
        )


def _start_warnings(case: Case) -> Iterator[str]:
    """Warn of a start in an overlap, where the head can lift the lower wire up to the other one."""
    for number, x in enumerate(case.start_positions, 1):
        for start, end in case.line.overlaps:
            if start < x < end:
                yield (
                    f"start of pantograph {number}: {x:g} m lies in the overlap from {start:g} m to {end:g} m. The "
                    "state at the start takes account of the lower contact wire only. Start outside of overlaps"
                )


def _working_height_warnings(case: Case) -> Iterator[str]:
    """Warn of an untuned pantograph whose static contact force at the working height is not its uplift force."""
    for number, (lift, file) in enumerate(zip(case.lift_forces, case.pantographs, strict=True), 1):
        if not isinstance(lift, AppliedForces):
            continue
        uplift_force = lift.uplift_force
        prefix, remedy = f"working height of pantograph {number}", "Give target_mean_force_N to be independent of it"
        if file.chain is not None and file.chain.base_spring_unstretched == "wire_height":
            stiffness = file.chain.stiffness_N_m[0]
            yield (
                f"{prefix}: its base spring is unstretched at the nominal height of the wire, so that it carries "
                f"{stiffness:g} N per metre of lift. A simulator that counts from the static height of the head has "
                f"another mean force. {remedy}"
            )
        elif not _states_uplift_point(file):
            yield (
                f"{prefix}: the uplift force acts on the head, as uplift_force_on is not given. The same pantograph as "
                "a chain has another mean force if its uplift force acts on a lower mass. Give uplift_force_on, or "
                "target_mean_force_N"
            )
        else:
            contact = _static_contact_force(file, lift)
            if abs(contact / uplift_force - 1) > LARGEST_STATIC_DIFFERENCE:
                yield (
                    f"{prefix}: with the head there, the static contact force is {contact:.4g} N, the uplift force "
                    f"{uplift_force:.4g} N, because displacements of all masses count from the height of the head. A "
                    f"simulator with another convention has another mean force. {remedy}"
                )


def _static_contact_force(file: PantographFile, lift: AppliedForces) -> float:
    """Contact force with the head at the working height [N]; NaN for a mechanism, which has no static state."""
    try:
        model = build_pantograph(file, lift.uplift_force, 0.0, aerodynamic_force=lift.aerodynamic_force)
        return float(equilibrium(model, 0.0)[1].sum())
    except np.linalg.LinAlgError:
        return math.nan


def _states_uplift_point(file: PantographFile) -> bool:
    table = file.matrices or file.modes
    return table is None or table.uplift_force_on is not None


def _contact_loss_warnings(evaluation: Evaluation) -> Iterator[str]:
    """Warn of a negative minimum of the filtered force."""
    for number, values in evaluation.values.items():
        smallest, loss = values.get("min_force_N"), values.get("contact_loss_pct")
        if number == LINE or not isinstance(smallest, float) or smallest >= 0:
            continue
        share = f", lost for {loss:.3g} % of the time" if isinstance(loss, float) else ""
        yield (
            f"contact loss: the smallest filtered force of pantograph {number} is {smallest:.3g} N{share}. No contact "
            "pulls: the filter undershoots where the force is zero. Judge contact_loss_pct in place of min_force_N"
        )


# Caveats for the 20-50 Hz band.
LARGEST_CHANGE = 0.05
"""Relative change of the RMS, with element length and time step halved, above which the mesh is too coarse."""

WARNING_PREFIX = "20-50 Hz: "
"""Prefix of these warnings."""

NOT_VALIDATED = (
    f"{WARNING_PREFIX}lumped models of pantographs and measuring chains are validated up to 20 Hz only; "
    "above 20 Hz, models are compared with each other and not with a line"
)


def warn_of_unvalidated_band(evaluation: Evaluation) -> list[str]:
    """Caveat for every record with values in the band, measured records included."""
    return [NOT_VALIDATED] if _band_values(evaluation) else []


def extended_band_warnings(evaluation: Evaluation, refined: Evaluation | None, dt_s: float | None) -> list[str]:
    """Warnings on the values between 20 and 50 Hz; none if there are no such values.

    Rate and filter of the record are checked where the values are computed: unsupported values are skipped.

    Args:
        evaluation: Quantities of the run.
        refined: Quantities of the same case with element length and time step halved; None if that was not run.
        dt_s: Time step of the run [s], if known.
    """
    band_values, warnings = _band_values(evaluation), warn_of_unvalidated_band(evaluation)
    if not band_values:
        return []
    if refined is None:
        step = "" if dt_s is None else f" (time step {dt_s:g} s)"
        return [
            *warnings,
            f"{WARNING_PREFIX}no run with a finer mesh and time step{step} shows whether the band is resolved",
        ]
    for pantograph, value in band_values.items():
        fine = refined.values.get(pantograph, {}).get(EXTENDED_BAND.quantity)
        if isinstance(value, float) and isinstance(fine, float) and not abs(value - fine) <= LARGEST_CHANGE * fine:
            warnings.append(
                f"{WARNING_PREFIX}halving element and time step changes the RMS of pantograph {pantograph} from "
                f"{value:.3g} N to {fine:.3g} N, by more than {100 * LARGEST_CHANGE:g} %: the band is not resolved"
            )
    return warnings


def _band_values(evaluation: Evaluation) -> dict[int, Value]:
    """RMS of the band, by pantograph."""
    name = EXTENDED_BAND.quantity
    return {owner: values[name] for owner, values in evaluation.values.items() if owner != LINE and name in values}
