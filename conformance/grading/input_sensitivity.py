"""Sentences and rows of a result from the stored studies of the inputs of its case."""

import math
from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import (
    ErrorBound,
    InputBounds,
    InputStudyFile,
    ResolvingPowerFile,
    find_conditions,
    find_resolving_power,
)
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.results.case_facts_format import ConditionFacts

NAMED_INPUTS = (
    "tension of the contact wire",
    "mass of the contact wire",
    "damping of the line, all coefficients",
    "mass of the head",
    "contact stiffness",
)
"""Inputs of the sentence on the errors that are noticed."""


def list_conditions(case: Case) -> list[ConditionFacts]:
    """Stored effects of untraced and open inputs on the values of a case; empty for another version of the case."""
    file = find_conditions(case.id)
    if file is None or file.case_digest != case.digest:
        return []
    rows = []
    for condition in file.condition:
        changes: dict[str, dict[str, float]] = {}
        for row in condition.change:
            changes.setdefault(str(row.pantograph), {})[row.quantity] = row.change_pct
        facts = condition.model_dump(include={"name", "group", "not_applicable"})
        rows.append(ConditionFacts(**facts, changes=changes))
    return rows


def describe_studies(case: Case) -> list[str]:
    """Sentences on the resolving power of a case, and on stored studies of another version of it."""
    conditions, power = find_conditions(case.id), find_resolving_power(case.id)
    sentences = []
    if conditions is not None and conditions.case_digest != case.digest:
        sentences.append(describe_other_version("conditions of the values", conditions))
    if power is None:
        return sentences
    if power.case_digest != case.digest or power.limits_digest != limits_digest(case.limits):
        return [*sentences, describe_other_version("resolving power", power)]
    return [*sentences, *describe_power(power)]


def list_possible_sentences(case: Case) -> set[str]:
    """Sentences of a case with its own limits and with those of a user."""
    return {*describe_studies(case), *describe_studies(case.without_limits())}


def describe_other_version(study: str, file: InputStudyFile) -> str:
    """Sentence on a stored study that does not belong to the inputs and limits of a case."""
    return (
        f"The {study} that the library stores (computed on {file.date}) belongs to another version of this case: "
        "to other inputs or limits. It is not stated here."
    )


def describe_power(file: ResolvingPowerFile) -> Iterator[str]:
    """Sentences on the errors that are noticed, and on those that are not."""
    by_name = {row.name: row for row in file.input}
    named = [by_name[name] for name in NAMED_INPUTS if name in by_name]
    how = f"computed on {file.date} with the reference simulator, one wrong input at a time, decision rule {file.rule}"
    found = list(_list_noticed(named, "up", "down"))
    if found:
        text = f"Resolving power ({how}): both verdicts together notice {'; '.join(found)}."
        alone = list(_list_noticed(named, "up_criteria", "down_criteria"))
        yield f"{text} The EN 50318 criteria alone notice {'; '.join(alone)}." if alone else text
    missed = [f"{row.name} ({_join_range(row)})" for row in file.input if _is_missed(row)]
    if missed:
        yield f"Not noticed up to the largest error that was tried: {', '.join(missed)}."


def _list_noticed(rows: Sequence[InputBounds], up: str, down: str) -> Iterator[str]:
    """Smallest errors that are noticed, by input, smaller values first."""
    for row in rows:
        bounds: list[tuple[str, ErrorBound | None]] = [("−", getattr(row, down)), ("+", getattr(row, up))]
        noticed = [
            f"{sign}{format_ceiling(bound.noticed)} {row.unit}"
            for sign, bound in bounds
            if bound is not None and bound.noticed is not None
        ]
        if noticed:
            yield f"{row.name} wrong by {' or '.join(noticed)}"


def format_ceiling(error: float) -> str:
    """Error with two significant digits, not below it: a smaller one is not known to be noticed."""
    digit = 10.0 ** (math.floor(math.log10(error)) - 1)
    return f"{math.ceil(round(error / digit, 9)) * digit:.6g}"


def _is_missed(row: InputBounds) -> bool:
    """Whether no error of an input was noticed in either direction."""
    bounds = [bound for bound in (row.up, row.down) if bound is not None]
    return bool(bounds) and all(bound.noticed is None for bound in bounds)


def _join_range(row: InputBounds) -> str:
    pairs = (("−", row.down), ("+", row.up))
    ends = [f"{sign}{bound.passed:g}" for sign, bound in pairs if bound is not None]
    return f"{' to '.join(ends)} {row.unit}"
