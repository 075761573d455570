"""Caveats for the 20-50 Hz band."""

from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value

LARGEST_CHANGE = 0.05
"""Relative change of the RMS, with element length and time step halved, above which the mesh is too coarse."""

WARNING_PREFIX = "20-50 Hz: "
"""Prefix of these warnings."""

NOT_VALIDATED = (
    f"{WARNING_PREFIX}lumped models of pantographs and measuring chains are validated up to 20 Hz only; "
    "above 20 Hz, models are compared with each other and not with a line"
)


def find_unvalidated(evaluation: Evaluation) -> list[str]:
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
    band_values, warnings = _band_values(evaluation), find_unvalidated(evaluation)
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
