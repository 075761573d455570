"""Numbers of a guide by name, for the documentation: all but computing times, dates and stamps."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.core.json_file import round_significant
from verification.guide.guide_format import INSIDE, Guide, LibraryCase, Topic


def list_guide_values(guide: Guide) -> dict[str, float]:
    """Numbers that are the same in every run of one version on one machine, with eight significant digits.

    Returns:
        Number by name, such as `library/en50318-2002/250/1/std_force_N/value`.
    """
    values: dict[str, float] = {}
    for name, topic in guide.verification.items():
        values |= {f"verification/{name}/{key}": value for key, value in _list_topic(topic)}
    for case in guide.library:
        values |= {f"library/{case.case}/{key}": value for key, value in _list_case(case)}
    values |= {f"counts/{name}": float(count) for name, count in count_results(guide).items()}
    return {name: round_significant(value) for name, value in values.items()}


def _list_topic(topic: Topic) -> Iterator[tuple[str, float]]:
    for row in topic.comparisons:
        yield f"{row.key}/computed", row.computed
        yield f"{row.key}/expected", row.expected
    for study in topic.convergence:
        yield f"{study.key}/order", study.orders[-1]
        yield f"{study.key}/error", study.errors[-1]


def _list_case(case: LibraryCase) -> Iterator[tuple[str, float]]:
    for owner, quantities in case.quantities.items():
        for name, value in quantities.items():
            if isinstance(value, list):
                for number, item in enumerate(value, 1):
                    yield f"{owner}/{name}/{number}/value", item
            else:
                yield f"{owner}/{name}/value", value
    for published in case.published:
        if published.uncertainty is not None and published.item is None:
            yield f"{published.pantograph}/{published.quantity}/uncertainty", published.uncertainty
    for row in case.converged:
        if row.discretisation is not None:
            yield f"{row.pantograph}/{row.quantity}/discretisation", row.discretisation
    stored = find_converged(case.case)
    for entry in () if stored is None else stored.value:
        yield f"{entry.owner}/{entry.quantity}/converged", entry.value
        yield f"{entry.owner}/{entry.quantity}/second", entry.second_value


def count_results(guide: Guide) -> dict[str, int]:
    """Numbers of agreements and of all comparisons of each section."""
    topics = guide.verification.values()
    checked = [row.agrees for topic in topics for row in topic.comparisons]
    checked += [study.agrees for topic in topics for study in topic.convergence]
    published = [row.verdict in INSIDE for case in guide.library for row in case.published]
    converged = [row for case in guide.library for row in case.converged]
    contained = [abs(row.value - row.first) <= row.discretisation for row in converged if row.discretisation]
    counts = {
        **_count("closed_forms", checked),
        **_count("published", published),
        **_count("formulations", [row.inside for row in converged]),
        **_count("contained", contained),
    }
    if guide.self_test is not None:
        parts: dict[str, Any] = {"records": guide.self_test.records, "numerical": guide.self_test.numerical}
        for name, faults in parts.items():
            counts |= _count(f"faults_{name}", [fault.detected for fault in faults if fault.must_be_detected])
    return counts


def _count(name: str, outcomes: list[bool]) -> dict[str, int]:
    return {f"{name}_agreeing": sum(outcomes), name: len(outcomes)}
