"""How much the figures of a run depend on where the evaluated stretch lies."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.records.record import Record

MIN_SECTIONS = 3


def section_spread(
    record: Record, stretches: Sequence[tuple[float, float]], low_pass: LowPass, values: dict[int, dict[str, Value]]
) -> dict[int, dict[str, float]]:
    """Largest departure of each quantity from its value when the evaluated stretch is shifted.

    A train of constant speed on a line of equal spans has figures that settle; until they have, and at high shares of
    the wave speed that takes tens of spans, they depend on where they are taken. This is an uncertainty of its own,
    which no refinement of the mesh makes smaller.

    Parameters
    ----------
    record : Record
        Of the run.
    stretches : Sequence[tuple[float, float]]
        Start and end of every stretch of the same length [m, m].
    low_pass : LowPass
        Filter of the graded force.
    values : dict[int, dict[str, Value]]
        On the evaluated stretch, by pantograph and name.

    Returns
    -------
    dict[int, dict[str, float]]
        In the units of the quantities, by pantograph and name; without what fewer than three stretches give.
    """
    shifted = [evaluate_record(replace(record, evaluated=stretch), low_pass).values for stretch in stretches]
    found: dict[int, dict[str, float]] = {}
    for of, quantities in values.items():
        found[of] = {}
        for name, value in quantities.items():
            others = [one.get(of, {}).get(name) for one in shifted]
            numbers = [other for other in others if isinstance(other, float | int)]
            if isinstance(value, float | int) and len(numbers) >= MIN_SECTIONS:
                found[of][name] = float(max(abs(other - value) for other in numbers))
    return {of: quantities for of, quantities in found.items() if quantities}
