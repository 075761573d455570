"""Uncertainty of the values of a case, component by component."""

from collections.abc import Sequence
from functools import partial

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.start_and_section import (
    has_short_run_in,
    list_earlier_sections,
    run_in_spans,
)
from pantocheck.conformance.grading.discretisation import discretisation_half_width
from pantocheck.conformance.grading.record_uncertainty import largest_changes, section_spread, widen_changes
from pantocheck.conformance.grading.uncertainty import Component, map_items
from pantocheck.conformance.quantities.evaluation import Evaluation, SectionedSignals, Value


def discretisation_component(coarse: Evaluation | None, value: Evaluation, fine: Evaluation | None) -> Component:
    """Uncertainty from mesh and time step.

    Args:
        coarse, value, fine: Quantities with element length and time step doubled, as in the case, and halved; None: not
            known.
    """
    if fine is None:
        return Component("not known: the system delivered one mesh and one time step only")
    half_widths: dict[int, dict[str, Value]] = {}
    for owner, quantities in value.values.items():
        finer = fine.values.get(owner, {})
        coarser = {} if coarse is None else coarse.values.get(owner, {})
        half_widths[owner] = {
            name: _half_width(coarser.get(name), number, finer[name])
            for name, number in quantities.items()
            if _same_items(finer.get(name), number)
        }
    meshes = "of the case and halved" if coarse is None else "doubled, of the case and halved"
    return Component(f"runs with element length and time step {meshes}", half_widths)


def _half_width(coarse: Value | None, value: Value, fine: Value) -> Value:
    """Half-width from mesh and time step of a number, or of each item."""
    if coarse is None or not _same_items(coarse, value):
        return map_items(partial(discretisation_half_width, None), value, fine)
    return map_items(discretisation_half_width, coarse, value, fine)


def _same_items(a: Value | None, b: Value) -> bool:
    """Whether two values are both numbers, or have equally many items."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b)
    return a is not None and not isinstance(a, tuple) and not isinstance(b, tuple)


def start_component(case: Case, signals: SectionedSignals, others: Sequence[Evaluation]) -> Component:
    """Uncertainty from the start and the run-in.

    Args:
        case: Case of the run.
        signals: Signals of the run.
        others: Quantities of the same case with other starts.
    """
    run_in = f"a run-in of {run_in_spans(case):.3g} spans"
    if others:
        changes = largest_changes(signals.evaluation.values, [other.values for other in others], len(others))
        basis = f"{len(others)} runs with other starts and ramps, after {run_in}"
        return Component(basis, widen_changes(changes))
    widths = section_spread(signals, list_earlier_sections(case))
    if widths:
        return Component(f"earlier sections of the same run, before which at least half of {run_in} is left", widths)
    if has_short_run_in(case):
        return Component(f"not known: after {run_in}, it needs runs with other starts")
    return Component("not known: the record does not contain earlier sections, with a shorter run-in")
