"""Section spread: change of the quantities of a run when the analysis section is shifted."""

from collections.abc import Sequence

from pantocheck.conformance.records.record_signals import RecordSignals

MIN_SECTIONS = 3
"""Smallest number of sections that give a spread."""


def section_spread(signals: RecordSignals, sections: Sequence[tuple[float, float]]) -> dict[int, dict[str, float]]:
    """Largest difference of each quantity from its value when the analysis section is shifted.

    At constant speed on equal spans, the quantities settle. At speeds near the wave speed this takes tens of spans;
    until then they depend on the analysis section. Mesh refinement does not reduce this uncertainty.

    Parameters
    ----------
    signals : RecordSignals
        Signals of the run.
    sections : sequence of tuple of float
        Start and end of every section of the same length [m, m].

    Returns
    -------
    dict of int to dict of str to float
        Spread in the units of the quantities, by pantograph and name; quantities available in fewer than
        `MIN_SECTIONS` sections are left out.
    """
    shifted = [signals.evaluate_section(section).values for section in sections]
    spread: dict[int, dict[str, float]] = {}
    for owner, quantities in signals.evaluation.values.items():
        for name, value in quantities.items():
            others = [values.get(owner, {}).get(name) for values in shifted]
            numbers = [other for other in others if isinstance(other, float | int)]
            if isinstance(value, float | int) and len(numbers) >= MIN_SECTIONS:
                spread.setdefault(owner, {})[name] = float(max(abs(other - value) for other in numbers))
    return spread
