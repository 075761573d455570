"""What must be known of the band from 20 to 50 Hz before its numbers are believed."""

from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.conformance.results.outcome import Delivered

LARGEST_CHANGE = 0.05
"""Change of the band's RMS by halving element and time step above which the mesh does not resolve it."""

WARNING_PREFIX = "20-50 Hz: "
"""Begin of every such warning."""
NOT_VALIDATED = (
    f"{WARNING_PREFIX}lumped models of pantographs and measuring chains are validated up to 20 Hz only; "
    "what lies above compares models with each other, not with a line"
)


def find_unvalidated(evaluation: Evaluation) -> list[str]:
    """What holds for every record that has numbers between 20 and 50 Hz, measured ones included."""
    return [NOT_VALIDATED] if _bands(evaluation) else []


def extended_band_warnings(outcome: Delivered, evaluation: Evaluation, refined: Evaluation | None) -> list[str]:
    """Warnings that belong to the numbers between 20 and 50 Hz; none where there are no such numbers.

    Rate and filter of the record are checked where the numbers are made: what they do not allow is skipped.

    Parameters
    ----------
    outcome : Delivered
        What the system delivered.
    evaluation : Evaluation
        Its quantities.
    refined : Evaluation or None
        Those of the same case with element and time step halved; None if that was not run.
    """
    bands, warnings = _bands(evaluation), find_unvalidated(evaluation)
    if not bands:
        return []
    if refined is None:
        step = "" if outcome.run.dt_s is None else f" (time step {outcome.run.dt_s:g} s)"
        return [
            *warnings,
            f"{WARNING_PREFIX}no run with a finer mesh and time step{step} shows whether the band is resolved",
        ]
    for of, value in bands.items():
        fine = refined.values.get(of, {}).get(EXTENDED_BAND.quantity)
        if isinstance(value, float) and isinstance(fine, float) and abs(value - fine) > LARGEST_CHANGE * fine:
            warnings.append(
                f"{WARNING_PREFIX}halving element and time step changes the RMS of pantograph {of} from "
                f"{value:.3g} N to {fine:.3g} N, by more than {100 * LARGEST_CHANGE:g} %: the band is not resolved"
            )
    return warnings


def _bands(evaluation: Evaluation) -> dict[int, Value]:
    """RMS of the band, by pantograph."""
    return {
        of: values[EXTENDED_BAND.quantity]
        for of, values in evaluation.values.items()
        if of != LINE and EXTENDED_BAND.quantity in values
    }
