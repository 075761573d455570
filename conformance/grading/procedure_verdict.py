"""Verdict of the EN 50318 procedure: of its steps, from their criteria, cases and claims, and of the whole."""

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import product

from pantocheck.conformance.core.criterion import Criterion, judge_criteria
from pantocheck.conformance.core.verdicts import WORST_FIRST, Verdict, normalise_distance, worst_verdict
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.results.procedure_format import Evidence, Procedure, ProcedureStep, ValidityClaim
from pantocheck.conformance.results.results_format import CaseResult

SAME_CONDITION = 1e-9
"""Relative tolerance between a claimed and a verified speed, spacing or input: the rounding of a number in a file."""

ANY = ""
"""Line or pantograph of a claim that names none."""


def judge_procedure(steps: Iterable[ProcedureStep]) -> Verdict:
    """Verdict of the procedure: its worst required step. A step that was not done is never better than `skip`."""
    return worst_verdict(step.verdict for step in steps if step.required)


def decide_procedure(
    procedure: Procedure, cases: Sequence[CaseResult], accepted: bool, lacking: Collection[str] = ()
) -> Procedure:
    """Procedure with the verdicts of its steps and claims.

    Args:
        procedure: Procedure whose verdicts are not decided, or are checked.
        cases: Results of all cases, with their verdicts.
        accepted: Whether the user accepts unconfirmed records of the system.
        lacking: Ids of the cases that lack a requested verification, which no acceptance replaces.

    Returns:
        The same procedure with its verdicts, margins and uncertainties.
    """
    by_id = {case.id: case for case in cases}
    references = {name for step in procedure.steps if step.step == "reference_models" for name in step.cases}
    verdicts = {
        case.id: _judge_case(case, case.id in references, accepted and case.id not in lacking) for case in cases
    }
    evidence = [item.model_copy(update={"passed": verdicts.get(item.id) == "pass"}) for item in procedure.evidence]
    steps: list[ProcedureStep] = []
    claims: list[ValidityClaim] = []
    for step in procedure.steps:
        named = [by_id[name] for name in step.cases if name in by_id]
        parts = [verdicts[case.id] for case in named]
        if step.step == "limits_of_validity":
            judged = [judge_claim(claim, procedure.claims, evidence) for claim in procedure.claims]
            claims = [require_steps_for_claim(claim, steps) for claim in judged]
            parts += [claim.verdict for claim in claims]
        if step.step == "reference_models" and not any("reference_models" in case.steps for case in named):
            parts.append("info")
        verdict = judge_step(step, parts, accepted)
        closest = describe_closest([*((None, row) for row in step.criteria), *_list_criteria(named)])
        steps.append(step.model_copy(update={"verdict": verdict, **closest}))
    return procedure.model_copy(update={"steps": steps, "evidence": evidence, "claims": claims})


def judge_step(step: ProcedureStep, parts: Sequence[Verdict], accepted: bool) -> Verdict:
    """Verdict of a step.

    Args:
        step: The step with its own criteria.
        parts: Verdicts of its cases and claims.
        accepted: Whether the user accepts unconfirmed records of the system.
    """
    if step.state != "done":
        return "error" if step.state == "error" else "skip"
    own = [judge_criteria(step.criteria)] if step.criteria else []
    verdict = worst_verdict([*own, *parts])
    return "unconfirmed" if verdict == "pass" and step.unconfirmed is not None and not accepted else verdict


def describe_closest(criteria: Iterable[tuple[str | None, Criterion]]) -> dict[str, str | float | None]:
    """Keys of a step on its counted criterion with the smallest margin.

    Args:
        criteria: Criteria with the ids of their cases.

    Returns:
        `closest`, `margin`, and `uncertainty` on the scale of the margin; None without a criterion that has a range and
        a value beside its limits.
    """
    counted = [
        (case, row)
        for case, row in criteria
        # Between two equal limits a margin is 0 at best and says nothing about closeness.
        if row.verdict in ("pass", "undecided", "fail")
        and row.margin is not None
        and row.lower != row.upper
        and not _equals_its_limit(row)
    ]
    if not counted:
        return {"closest": None, "margin": None, "uncertainty": None}
    case, row = min(counted, key=lambda item: item[1].margin or 0.0)
    width = math.hypot(row.uncertainty or 0.0, row.limit_uncertainty or 0.0)
    name = criterion_name(row) if case is None else f"{case}, {criterion_name(row)}"
    return {
        "closest": name,
        "margin": row.margin,
        "uncertainty": normalise_distance(width, row.lower, row.upper) or None,
    }


def _equals_its_limit(row: Criterion) -> bool:
    """Whether an exact value, such as a declared element length, is the limit itself: it has no margin."""
    return row.margin == 0 and not row.uncertainty and not row.limit_uncertainty


def judge_claim(claim: ValidityClaim, claims: Sequence[ValidityClaim], evidence: Sequence[Evidence]) -> ValidityClaim:
    """Claim with its verdict: verified for every claimed line with every claimed pantograph, or not verified.

    Args:
        claim: The claim.
        claims: All claims; those on lines and pantographs limit the runs that count.
        evidence: Conditions of all runs.
    """
    passed = [item for item in evidence if item.passed]
    lines, pantographs = (
        [claim.name] if claim.kind == kind else [other.name for other in claims if other.kind == kind] or [ANY]
        for kind in ("line", "pantograph")
    )
    groups = {
        (line, pantograph): [item for item in passed if _belongs(item, line, pantograph) and _values(claim, item)]
        for line, pantograph in product(lines, pantographs)
    }
    found = sorted({item.id for group in groups.values() for item in group})
    ranges = [_range(claim, group) for group in groups.values() if group]
    empty = next((pair for pair, group in groups.items() if not group), None)
    if empty is not None:
        missing = f"no run passed{_describe_run(*empty)}"
        return claim.model_copy(update={"verified": None, "evidence": found, "verdict": "skip", "reason": missing})
    if claim.claimed is None:
        return claim.model_copy(update={"verified": None, "evidence": found, "verdict": "pass", "reason": None})
    verified = (max(low for low, _ in ranges), min(high for _, high in ranges))
    inside = _covers(verified, claim.claimed)
    reason = None if inside else f"the runs that passed cover {verified[0]:g} to {verified[1]:g} {claim.unit}".rstrip()
    shown = verified if verified[0] <= verified[1] else None
    verdict: Verdict = "pass" if inside else "skip"
    return claim.model_copy(update={"verified": shown, "evidence": found, "verdict": verdict, "reason": reason})


def require_steps_for_claim(claim: ValidityClaim, steps: Sequence[ProcedureStep]) -> ValidityClaim:
    """Claim that passes only if every step before it passes, required or not.

    A step that fails or has an error leaves the claim not verified: `skip`. Its removal then never improves the claim.

    Args:
        claim: Claim with the verdict of its runs.
        steps: Steps before the limits of validity, with their verdicts.
    """
    missing = [(number, step) for number, step in enumerate(steps, 1) if step.verdict != "pass"]
    if not missing:
        return claim
    verdict = max(worst_verdict([claim.verdict, *(step.verdict for _, step in missing)]), "skip", key=WORST_FIRST.index)
    listed = ", ".join(
        f"step {number} ({step.step.replace('_', ' ')}) {_describe_state(step)}" for number, step in missing
    )
    reason = f"{claim.reason or 'rests on runs only'}; {listed}"
    return claim.model_copy(update={"verified": None, "verdict": verdict, "reason": reason})


def is_reference(case: CaseResult) -> bool:
    """Whether a case is an unchanged case of the library; limits of the user do not change it."""
    return case.library == "identical"


def _judge_case(case: CaseResult, as_reference: bool, accepted: bool) -> Verdict:
    """Verdict of a case in its step; the pass of an own or changed case, which is not a reference model, is `info`."""
    verdict: Verdict = "pass" if accepted and case.verdict == "unconfirmed" else case.verdict
    return worst_verdict([verdict, "info"]) if as_reference and not is_reference(case) else verdict


def _list_criteria(cases: Iterable[CaseResult]) -> Iterator[tuple[str | None, Criterion]]:
    return ((case.id, row) for case in cases for row in case.criteria)


def _belongs(item: Evidence, line: str, pantograph: str) -> bool:
    return line in (ANY, item.line) and (pantograph == ANY or pantograph in item.pantographs)


def _values(claim: ValidityClaim, item: Evidence) -> list[float]:
    """Values of a run that support a claim on a range; for a line or a pantograph, the run itself."""
    match claim.kind:
        case "speed":
            return [item.speed_km_h]
        case "spacing":
            return item.spacing_m
        case "change":
            return [item.inputs[claim.name]] if claim.name in item.inputs else []
        case _:
            return [0.0]


def _range(claim: ValidityClaim, group: Sequence[Evidence]) -> tuple[float, float]:
    values = [value for item in group for value in _values(claim, item)]
    return min(values), max(values)


def _covers(verified: tuple[float, float], claimed: tuple[float, float]) -> bool:
    slack = SAME_CONDITION * max(map(abs, (*verified, *claimed)))
    return verified[0] <= claimed[0] + slack and claimed[1] <= verified[1] + slack


def _describe_state(step: ProcedureStep) -> str:
    return "not done" if step.state == "not done" else f"has the verdict {step.verdict.upper()}"


def _describe_run(line: str, pantograph: str) -> str:
    on = f" on line {line!r}" if line else ""
    return on + (f" with pantograph {pantograph!r}" if pantograph else "")
