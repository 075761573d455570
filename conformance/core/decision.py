"""Decision rule: the part that the uncertainty of a value has in its verdict.

A rule is stated with every verdict (ISO/IEC 17025:2017, 7.8.6.1). The names and the risk are those of JCGM 106:2012,
clauses 8 and 9. EN 50318 states no rule, so the default is simple acceptance.
"""

import re
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS, LimitPair, ValueErrors
from pantocheck.conformance.core.verdicts import Verdict, judge

DECISION_PATTERN = r"^(simple|guarded|shared-risk:0\.[0-9]{1,4})$"
DecisionText = Annotated[str, Field(pattern=DECISION_PATTERN)]
"""Text of a decision rule in plans, dossiers, results and on the command line."""


@dataclass(frozen=True)
class SimpleAcceptance:
    """A value inside its limits passes; its distance from them is shown."""


@dataclass(frozen=True)
class GuardedAcceptance:
    """A value passes only if its interval of uncertainty lies inside the limits."""


@dataclass(frozen=True)
class SharedRisk:
    """A value passes only if the probability that it lies outside the limits is small."""

    largest_risk: float
    """Largest accepted probability of a wrong acceptance [-]."""


DecisionRule = SimpleAcceptance | GuardedAcceptance | SharedRisk

SIMPLE = SimpleAcceptance()


def parse_decision(text: str, where: str = "option --decision") -> DecisionRule:
    """Decision rule of its text: `simple`, `guarded`, or `shared-risk:` and the largest accepted risk.

    Raises:
        InputError: The text is not a rule, or the risk is not between 0 and 0.5.
    """
    if re.fullmatch(DECISION_PATTERN, text):
        name, _, risk = text.partition(":")
        if not risk:
            return SIMPLE if name == "simple" else GuardedAcceptance()
        if 0 < float(risk) <= 0.5:
            return SharedRisk(float(risk))
    raise InputError(where, f"found {text!r}", "Give simple, guarded, or a shared risk up to 0.5: shared-risk:0.05.")


def format_decision(rule: DecisionRule) -> str:
    """Text of a decision rule, as `parse_decision` reads it."""
    if isinstance(rule, SharedRisk):
        return f"shared-risk:{f'{rule.largest_risk:.4f}'.rstrip('0')}"
    return "simple" if rule == SIMPLE else "guarded"


def describe_decision(rule: DecisionRule) -> str:
    """Decision rule in a sentence for a page."""
    close = (
        "a value inside its limits passes, and is counted as close if its interval of uncertainty reaches over a limit"
    )
    match rule:
        case SimpleAcceptance():
            return f"simple acceptance: {close}"
        case GuardedAcceptance():
            inside = "its interval of uncertainty lies inside the limits"
            return f"guarded acceptance: a value passes if {inside}; else it is undecided"
        case SharedRisk(risk):
            chance = f"the probability that it lies outside the limits is at most {risk:g}"
            return f"shared risk: a value passes if {chance}; else it is undecided"


def judge_by_rule(
    value: float, limits: LimitPair, errors: ValueErrors, rule: DecisionRule
) -> tuple[Verdict, str | None]:
    """Verdict of a value by a decision rule, and the reason why it is undecided.

    A value outside its limits fails under every rule, so that an unknown or large uncertainty never improves a verdict.
    A value inside passes under no rule if the sampling rate or the resolution of the record may have moved it there.

    Args:
        value: Graded value.
        limits: Lower and upper limit; at least one must be given.
        errors: Errors of the value.
        rule: Decision rule.
    """
    if judge(value, *limits) == "fail":
        return "fail", None
    if any(name in errors.unknown for name in BOUNDED_COMPONENTS):
        return "undecided", "the effect of the sampling rate, resolution or clocks of the record is not known"
    if errors.record_bound and not _contains(limits, value, errors.record_bound):
        return "undecided", "sampling rate, resolution or clocks of the record may have moved it inside the limit"
    match rule:
        case SimpleAcceptance():
            return "pass", None
        case _ if errors.unknown or errors.limit_uncertainty is None:
            names = ", ".join(errors.unknown or ["that of the limit"])
            return "undecided", f"its uncertainty is not complete: {names} not known"
        case GuardedAcceptance():
            inside = _contains(limits, value, errors.find_expanded(value))
            return ("pass", None) if inside else ("undecided", "its interval of uncertainty reaches over a limit")
        case SharedRisk(largest_risk):
            conformity = errors.find_conformity(limits)
            if conformity is None:  # no joint sample: the value has one component, or none
                return judge_by_rule(value, limits, errors, GuardedAcceptance())
            risk = 1 - conformity
            if risk <= largest_risk:
                return "pass", None
            return "undecided", f"it lies outside the limits with a probability of {risk:.2g}, above {largest_risk:g}"


def _contains(limits: LimitPair, value: float, half_width: float) -> bool:
    """Whether the limits contain the whole interval around a value."""
    return judge(value - half_width, *limits) == judge(value + half_width, *limits) == "pass"
