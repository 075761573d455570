"""Reasons of a verdict: failed and missing criteria, close values and the smallest margins."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from pantocheck.conformance.core.criterion import COMPONENT_NAMES, Criterion
from pantocheck.conformance.core.decision import describe_decision, parse_decision
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages.criteria_table import criterion_title, format_probability
from pantocheck.conformance.pages.document import BulletList, Section
from pantocheck.conformance.pages.findings_table import describe_counts
from pantocheck.conformance.pages.scope_page import build_procedure_headline, summarise_identity
from pantocheck.conformance.pages.two_verdicts import verdict_sentences
from pantocheck.conformance.pages.verdict_marks import count_close, list_criteria, select_criteria
from pantocheck.conformance.pages.words import (
    format_beside_limits,
    format_plain,
    format_value,
    name_owner,
    read_words,
    replace_minus,
)
from pantocheck.conformance.quantities.limit_text import format_criterion_margin
from pantocheck.conformance.results.incomplete_uncertainty import list_missing
from pantocheck.conformance.results.results_format import CaseConformity, CaseResult, Results

CLOSE_HEADING = "Closer to a limit than the uncertainty"
"""Heading of the close values."""

NAMES_SHOWN = 5
"""Number of cases for information that the headline names."""

CLAUSES = {
    "error": ("ends in an error", "end in an error"),
    "fail": ("fails", "fail"),
    "undecided": ("is undecided", "are undecided"),
    "skip": ("could not be evaluated completely", "could not be evaluated completely"),
    "info": ("has no limit that counts", "have no limit that counts"),
    "unconfirmed": ("has an unconfirmed record", "have an unconfirmed record"),
}
"""Parts of the headline by verdict, in the singular and the plural, the worst first."""


CaseCriterion = tuple[CaseResult, Criterion]
"""A case and one of its criteria."""


def build_headline(results: Results) -> str:
    """The verdict in sentences: passed cases, reasons against a better verdict, and the exceptions of the user."""
    if results.procedure is not None:
        return build_procedure_headline(results, results.procedure)
    cases = [case for case in results.cases if case.id not in results.information]
    verdicts: Counter[str] = Counter(case.verdict for case in cases)
    accepts, requested = results.system.name in results.accepted_unconfirmed, "verification" in results.requested
    alone = sum(_lacks_verification(case, accepts) for case in cases) if requested else 0
    accepted = verdicts["unconfirmed"] - alone if accepts else 0
    passed, verdicts["unconfirmed"] = verdicts["pass"] + accepted, verdicts["unconfirmed"] - accepted
    pairs = [(case, row) for case in cases for row in select_criteria(results, case)]
    grades = Counter(row.verdict for _, row in pairs if not row.is_drift)
    counted = sum(grades[verdict] for verdict in ("pass", "undecided", "fail", "skip", "error"))
    total = count_noun(len(cases), "case")
    doubted = [row for case in cases for row in case.criteria if row.doubt is not None]
    judged, unjudged = len(cases) - verdicts["info"], verdicts["info"]
    if not cases:
        sentences = ["No case takes part in the verdict."]
    elif results.verdict == "info" and doubted:
        names = count_noun(len(doubted), "own limit is", "own limits are")
        sentences = [f"Nothing is judged: {names} wider than those of the library, or too wide to test anything."]
    elif not judged:
        sentences = [f"{count_noun(unjudged, 'case')} computed, no limit to judge {'it' if unjudged == 1 else 'them'}."]
    elif passed == judged and results.verdict in ("pass", "unconfirmed"):
        close = count_close(results)
        near = f", {close} of them close to a limit" if close else ""
        rest = f"; {count_noun(unjudged, 'case')} not judged" if unjudged else ""
        total = count_noun(judged, "case")
        names = name_limits(pairs)
        values = "The value" if counted == 1 else f"All {counted} values"
        lie = "lies" if counted == 1 else "lie"
        sentences = [f"{values} with a limit that counts in {total} {lie} inside {names}{near}{rest}."]
    else:
        parts = [f"{passed} of {total} {'passes' if 1 in (passed, len(cases)) else 'pass'}"]
        if alone:
            verdicts["unconfirmed"] -= alone
            parts.append(f"{count_noun(alone, 'passes', 'pass')} the criteria without a verification up to 50 Hz")
        for verdict, (one, many) in CLAUSES.items():
            if number := verdicts[verdict]:
                outside = _list_failures(grades["fail"], counted, [pair for pair in pairs if pair[1].is_drift])
                parts.append(f"{count_noun(number, one, many)}{outside if verdict == 'fail' else ''}")
        sentences = [f"{', '.join(parts)}."]
    if counted and _is_static_only(pairs):
        sentences.append("No value of a passage has a limit that counts.")
    if accepted:
        sentences.append(f"Accepted by the user: unconfirmed records of {results.system.name}.")
    if shown := results.information:
        more = f" and {len(shown) - NAMES_SHOWN} more" if len(shown) > NAMES_SHOWN else ""
        sentences.append(f"For information, not part of the verdict: {', '.join(shown[:NAMES_SHOWN])}{more}.")
    if number := sum(row.depends_on_reading for _, row in pairs):
        values = count_noun(number, "value lies", "values lie")
        other = "another documented reading of the evaluation or another contact"
        sentences.append(f"{values} on the other side of a limit under {other}.")
    return " ".join([*sentences, *verdict_sentences(results), *describe_counts(results), *summarise_identity(results)])


def _is_static_only(pairs: Sequence[CaseCriterion]) -> bool:
    """Whether there are passages, and only values of lines at rest have a limit that counts."""
    moving = [row.verdict for case, row in pairs if case.run.speed_km_h is not None]
    return bool(moving) and set(moving) == {"info"}


def name_limits(pairs: Iterable[CaseCriterion]) -> str:
    """Whose limits the passed criteria meet: edition, source and trust; `their limits` for more than two sources."""
    passed = [(case, row) for case, row in pairs if row.verdict == "pass" and not row.is_drift]
    names = dict.fromkeys(_name_limit(case, row) for case, row in passed)
    return " and ".join(names) if 0 < len(names) <= 2 else "their limits"


def _name_limit(case: CaseResult, row: Criterion) -> str:
    if row.trust in ("own", "computed"):
        return "limits of the user" if row.trust == "own" else "the limits of the converged solution"
    authors = row.source.partition(":")[0].split(", ")
    printed = f" as printed by {authors[0].removesuffix(' et al.')} et al." if len(authors) > 2 else ""
    if not printed and row.source and row.trust != "primary":
        printed = f" as given by {row.source.partition(':')[0]}"
    return f"the limits of {case.edition or case.profile or 'the case'}{printed} ({row.trust} source)"


def _lacks_verification(case: CaseResult, accepted: bool) -> bool:
    """Whether a case is unconfirmed because it has no verification, with a consistent or accepted record."""
    alone = case.verdict == "unconfirmed" and case.verification is None and case.profile is None
    return alone and case.record is not None and (accepted or case.record.state == "consistent")


def _list_failures(failed: int, counted: int, drifts: list[CaseCriterion]) -> str:
    """Numbers of criteria outside their limits and of drifted values, with the largest drift; empty without any."""
    parts = [f"{failed} of {counted} values outside limits that count"] if counted else []
    if drifted := [pair for pair in drifts if pair[1].verdict == "fail"]:
        # The margin is the drift in units of the accepted one.
        case, row = min(drifted, key=lambda pair: pair[1].margin or 0.0)
        change = (row.reason or "").partition(" from ")[0].removeprefix("drifted ")
        largest = f"{row.quantity} of {case.id} {change}".rstrip()
        parts.append(f"{count_noun(len(drifted), 'value')} drifted from the baseline, most {largest}")
    return f" ({', '.join(parts)})" if parts else ""


def describe_record(case: CaseResult) -> str | None:
    """The state of the record of a case in one sentence; None without a record."""
    record = case.record
    if record is None:
        return None
    remark = "" if record.demanded else " The profile does not demand consistency."
    return f"Record {record.state}: {record.reason}.{remark}"


def list_reasons(results: Results) -> tuple[Section, ...]:
    """Sentences under headings, errors first; a heading without sentences is left out."""
    passed = _select(results, "pass")
    drifts = [(case, row) for case in results.cases for row in select_criteria(results, case) if row.is_drift]
    groups = {
        "Errors": [*_case_reasons(results, "error"), *map(_reason, _select(results, "error"))],
        "Failed": [*_case_reasons(results, "fail"), *map(_value, _select(results, "fail"))],
        "Undecided": [*map(_reason, _select(results, "undecided"))],
        "Not evaluated": [*_case_reasons(results, "skip"), *map(_reason, _select(results, "skip"))],
        "Drift from the baseline": [_reason(pair) for pair in drifts],
        "Not confirmed": [
            f"{case.id}: {describe_record(case)}"
            for case in results.cases
            if case.record and case.record.state == "unconfirmed"
        ],
        "Inside the limits only with the stated start": [_reason(pair) for pair in passed if pair[1].reason],
        CLOSE_HEADING: _list_close(results),
        "Another documented reading or contact reverses the verdict": [
            f"{_subject(*pair)}: {'; '.join(pair[1].readings)}."
            for pair in _criteria(results)
            if pair[1].depends_on_reading
        ],
        "Limits of the user": [_own_limit(pair) for pair in _criteria(results) if pair[1].trust == "own"],
    }
    return tuple(
        Section(heading, (BulletList(tuple(sentences)),)) for heading, sentences in groups.items() if sentences
    )


def state_decision(results: Results) -> str:
    """Sentences on the decision rule, and on the probability that all values lie inside the limits that count."""
    chance = describe_chance(results)
    shown = f" Probability that all values lie inside the limits that count: {chance}." if chance else ""
    return f"Decision rule: {describe_rule(results)}.{shown}"


def describe_rule(results: Results) -> str:
    """Name of the decision rule, with its meaning behind a colon."""
    return describe_decision(parse_decision(results.decision, "results, key decision"))


def describe_chance(results: Results) -> str:
    """Probability that all values lie inside the limits that count, with that of each case; empty: not known."""
    if results.conformity is None:
        return ""
    pairs = [(case.id, case.conformity) for case in results.cases if case.conformity]
    shares = [f"{name}: {_describe_chances(of)}" for name, of in pairs]
    return f"{format_probability(results.conformity)} ({'; '.join(shares)})"


def _describe_chances(of: CaseConformity) -> str:
    """Probability of a case, its starts that pass, and the probability under its other readings."""
    starts = [f"{of.passing_starts} of {of.starts} runs pass, each with another start"] if of.starts else []
    readings = [f"{format_probability(share)} under the reading '{name}'" for name, share in of.readings.items()]
    return ", ".join([format_probability(of.probability), *starts, *readings])


CHANCE_KEY = (
    "Probability: share of the joint sample of the known uncertainties in which all values of a case lie inside the "
    "limits that count. It says nothing about errors of the model. Runs with another start are counted beside it."
)
"""Meaning of the probability of page 1."""

UNCERTAINTY_MEANING = (
    "±: half-width around the value that holds 95 % of the draws of the joint sample. The sample can be skewed, so "
    "that the probability does not follow from ± alone."
)


def explain_uncertainty(results: Results) -> str:
    """Meaning of the half-widths, and the components that they lack; empty if no value has one."""
    known = any(row.uncertainty is not None for case in results.cases for row in case.criteria)
    return " ".join(filter(None, (UNCERTAINTY_MEANING if known else "", state_incomplete(results))))


def state_incomplete(results: Results) -> str | None:
    """Sentence on the values with a limit that counts whose uncertainty lacks a component; None if there are none."""
    counted = [pair for pair in _criteria(results) if pair[1].verdict in ("pass", "undecided", "fail")]
    missing = [list_missing(case.uncertainty_basis, row.uncertainty, row.trust) for case, row in counted]
    if not (number := sum(map(bool, missing))):
        return None
    names = " or ".join(name for name in COMPONENT_NAMES if any(name in lacking for lacking in missing))
    return (
        f"The uncertainty of {count_noun(number, 'value')} is incomplete ({names} not known): more of them may be "
        "close to a limit."
    )


def summarise_case(case: CaseResult) -> str:
    """The verdict of one case in one sentence."""
    if case.reason:
        return case.reason
    verdicts = Counter(criterion.verdict for criterion in list_criteria(case, "criteria"))
    words = read_words()["verdict"]
    parts = [
        f"{verdicts[verdict]} {words[verdict]['meaning'] if verdict != 'info' else 'with a limit that does not count'}"
        for verdict in ("error", "fail", "undecided", "skip", "pass", "info")
        if verdicts[verdict]
    ]
    return (
        f"{sum(verdicts.values())} criteria: {', '.join(parts)}."
        if parts
        else "No criteria: there is no published limit."
    )


def _criteria(results: Results) -> Iterator[CaseCriterion]:
    """Criteria of the verdicts that decide, without those of drift."""
    return ((case, row) for case in results.cases for row in select_criteria(results, case) if not row.is_drift)


def _select(results: Results, verdict: str) -> list[CaseCriterion]:
    """Criteria with one verdict, the smallest margin first."""
    pairs = [pair for pair in _criteria(results) if pair[1].verdict == verdict]
    return sorted(pairs, key=lambda pair: pair[1].margin or 0.0)


def _case_reasons(results: Results, verdict: str) -> list[str]:
    """Reasons of cases; cases with the same reason share a sentence."""
    cases: dict[str, list[str]] = {}
    for case in results.cases:
        if case.verdict == verdict and case.reason:
            cases.setdefault(case.reason, []).append(case.id)
    return [f"{', '.join(ids)}: {reason}" for reason, ids in cases.items()]


def _value(pair: CaseCriterion) -> str:
    case, criterion = pair
    value, limits = format_beside_limits(criterion.value, criterion.lower, criterion.upper)
    shown = format_criterion_margin(criterion.margin, criterion.lower, criterion.upper, criterion.unit)
    margin = "" if criterion.margin is None else f", margin {replace_minus(shown)}"
    text = f"{_subject(case, criterion)}: {value} {criterion.unit}".rstrip()
    return f"{text}, limits {limits}{margin}."


def _list_close(results: Results) -> list[str]:
    """Names of the close values, one sentence for each case."""
    names: dict[str, list[str]] = {}
    for case, row in _criteria(results):
        if row.is_close:
            owner = f" of {name_owner(row)}" if row.pantograph > 1 or row.item else ""
            names.setdefault(case.id, []).append(f"{criterion_title(row)}{owner}{_name_verification(row)}")
    return [f"{case}: {'; '.join(close)}." for case, close in names.items()]


def _own_limit(pair: CaseCriterion) -> str:
    """Limits of the user; between two, the tolerance in the unit and in per cent of the middle."""
    case, row = pair
    _, limits = format_beside_limits(row.value, row.lower, row.upper)
    text = f"{_subject(case, row)}: {limits} {row.unit}".rstrip()
    if row.lower is None or row.upper is None:
        return f"{text}."
    width, middle = (row.upper - row.lower) / 2, abs(row.upper + row.lower) / 2
    share = f", {format_plain(float(f'{100 * width / middle:.2g}'))} %" if middle else ""
    return f"{text}, ± {format_value(width, 2)} {row.unit}".rstrip() + f"{share}."


def _reason(pair: CaseCriterion) -> str:
    case, criterion = pair
    return f"{_subject(case, criterion)}: {criterion.reason or 'no reason given'}"


def _subject(case: CaseResult, criterion: Criterion) -> str:
    return f"{case.id}, {name_owner(criterion)}, {criterion_title(criterion)}{_name_verification(criterion)}"


def _name_verification(criterion: Criterion) -> str:
    return ", verification" if criterion.trust == "computed" else ""
