"""Stretches that a measured record leaves out of the evaluation, as far as the profile permits it.

An exclusion can hide the places of large forces. It therefore needs a stated reason, a kind that the profile permits,
and a bounded share; without them the whole analysis section is evaluated. No profile of the library permits one.
"""

from collections.abc import Sequence

from pantocheck.conformance.cases.profile_file import ExclusionRule
from pantocheck.conformance.records.events import RecordEvent, covered_share
from pantocheck.conformance.results.case_facts_format import EventFacts

Stretches = tuple[tuple[float, float], ...]


def apply_exclusions(
    events: Sequence[RecordEvent], section: tuple[float, float], rule: ExclusionRule | None
) -> tuple[Stretches, tuple[EventFacts, ...], tuple[str, ...]]:
    """Decide which events of a record are left out.

    Args:
        events: Events of the analysis section.
        section: Start and end of the analysis section [m].
        rule: Rule of the profile; None: nothing may be left out.

    Returns:
        excluded: Stretches that are left out [m, m].
        facts: Every event, with the reason why it is left out or not.
        warnings: Sentences on what is left out, and on exclusions that are not applied.
    """
    wanted = [event for event in events if event.reason is not None]
    permitted = [event for event in wanted if rule is not None and event.kind in rule.kinds]
    share = 100 * covered_share([(event.start, event.end) for event in permitted], section)
    applied = rule is not None and bool(permitted) and share <= rule.largest_share_pct
    refusal = (
        "the profile permits no exclusion"
        if rule is None
        else f"{share:.3g} % of the section would be left out, the profile permits {rule.largest_share_pct:g} %"
    )
    facts = []
    for event in events:
        excluded = applied and event in permitted
        reason = refusal if rule is None or event in permitted else f"the profile permits no exclusion of {event.kind}"
        remark = "" if event.reason is None else event.reason if excluded else f"evaluated: {reason}"
        facts.append(
            EventFacts(
                kind=event.kind,
                name=event.name,
                start_m=event.start,
                end_m=event.end,
                excluded=excluded,
                remark=remark,
            )
        )
    return (
        tuple((event.start, event.end) for event in permitted) if applied else (),
        tuple(facts),
        tuple(_warn(facts, wanted, share, applied=applied)),
    )


def _warn(facts: Sequence[EventFacts], wanted: Sequence[RecordEvent], share: float, *, applied: bool) -> list[str]:
    """Sentences for the reader of the report."""
    warnings = []
    if applied:
        places = "; ".join(
            f"{fact.kind.replace('_', ' ')} {fact.name} {fact.start_m:.1f}-{fact.end_m:.1f} m ({fact.remark})".replace(
                "  ", " "
            )
            for fact in facts
            if fact.excluded
        )
        warnings.append(f"{share:.3g} % of the analysis section is left out of the force statistics: {places}")
    refused = {fact.remark.removeprefix("evaluated: ") for fact in facts if fact.remark and not fact.excluded}
    if wanted and refused:
        warnings.append(f"stretches that the record wants to leave out are evaluated: {'; '.join(sorted(refused))}")
    return warnings
