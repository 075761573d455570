"""Identity of a case: comparison with the library, digest of the limits, changes by a limits file."""

from collections.abc import Sequence
from typing import Any

from pantocheck.conformance.cases.case import Case, json_digest
from pantocheck.conformance.cases.library import find_library_case, list_library_limits
from pantocheck.conformance.cases.limits import Limit, own_limits
from pantocheck.conformance.cases.profile_file import Profile, list_profiles, load_profile
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.core.criterion import Requirement
from pantocheck.conformance.core.trust import LEVELS
from pantocheck.conformance.quantities.limit_text import format_bounds, name_value
from pantocheck.conformance.results.results_format import LibraryIdentity

_FINDING_TEXTS = {"section", "statement", "sentence", "printed", "tolerance", "sensitivity"}
_REMARKS: dict[str, bool | set[str]] = {"note": True, "case": True, "finding": _FINDING_TEXTS}
"""Texts of a limit, which do not change its grade."""


def compare_with_library(case: Case) -> LibraryIdentity:
    """Compare the content of a case with the library case of the same id.

    The comparison covers inputs, limits and their sources, as the case file states them. It excludes the names of
    files, the user's own limits and the damping study, because they are options of the run.
    """
    if (known := find_library_case(case.id)) is None:
        return "own"
    return "identical" if _content_digest(case) == _content_digest(known) else "modified"


def compare_profile_with_library(profile: Profile) -> LibraryIdentity:
    """Compare a profile with the library profile of the same name."""
    if profile.name not in list_profiles():
        return "own"
    return "identical" if profile == load_profile(profile.name) else "modified"


def _content_digest(case: Case) -> str:
    is_option = isinstance(case.file.study, DampingSensitivity)
    names: dict[str, Any] = {
        "line": True,
        "damping": True,
        "pantograph": {"__all__": {"model"}},
        "apparent_mass": {"model"},
    }
    file = case.file.model_copy(update={"study": None}) if is_option else case.file
    return json_digest(
        {
            "file": file.model_dump(mode="json", exclude=names),
            "line": case.line.model_dump(mode="json"),
            "pantographs": [file.model_dump(mode="json") for file in case.pantograph_files],
            "dampings": {} if is_option else {name: model.model_dump() for name, model in case.dampings.items()},
        }
    )


def limits_digest(limits: Sequence[Limit]) -> str:
    """SHA-256 of limits with trust and source, in any order."""
    content = [limit.model_dump(mode="json", exclude=_REMARKS) for limit in limits]
    return json_digest(sorted(content, key=repr))


def rules_digest(profile: Profile) -> str:
    """SHA-256 of the rules of a profile with trust and source."""
    return json_digest([rule.model_dump(mode="json", exclude={"note"}) for rule in profile.rule])


def profile_limits_digest(profile: Profile, limits: Sequence[Limit] = ()) -> str:
    """SHA-256 of the rules of a profile and of the user's own limits."""
    return json_digest([rules_digest(profile), limits_digest(limits)])


def list_limit_changes(case: Case) -> list[str]:
    """Sentences on the limits of the case file that the user's limits weaken, remove or give another trust."""
    limits = {limit.target: limit for limit in case.limits}
    stated_limits = own_limits(case.file.limit, list_library_limits(case.id))
    changes = (describe_limit_change(stated, limits.get(stated.target)) for stated in stated_limits)
    return [change for change in changes if change is not None]


def describe_limit_change(stated: Limit, limit: Limit | None) -> str | None:
    """Change of a limit by the limit that replaces it; None if it is as strict and of the same trust.

    Args:
        stated: Limit of the case or profile.
        limit: Limit of the user that replaces it; None if it was removed.
    """
    name = name_limit(stated)
    bounds = format_bounds(stated.lower, stated.upper)
    if limit is None:
        return f"{name}: the limit {bounds} is removed"
    parts = []
    if _is_wider(stated, limit):
        parts.append(f"the limit {bounds} is widened to {format_bounds(limit.lower, limit.upper)}")
    if limit.trust not in LEVELS:  # own, or a word of a forged document
        others = f"the trust of the limit is {limit.trust} in place of {stated.trust}"
        parts += [] if stated.trust == limit.trust else [others]
    elif stated.trust not in {limit.trust, "own"}:
        change = "lowered" if LEVELS.index(limit.trust) > LEVELS.index(stated.trust) else "raised"
        parts.append(f"the trust of the limit is {change} from {stated.trust} to {limit.trust}")
    if stated.is_imposed and not limit.is_imposed:
        parts.append("an imposed finding counts")
    return f"{name}: {', and '.join(parts)}" if parts else None


def explain_widened_limit(case_id: str, limit: Limit | Requirement) -> str | None:
    """Reason why a pass by a limit of the user does not count: it widens one of the library. None: it counts."""
    stated = list_library_limits(case_id) if limit.trust == "own" else ()
    widened = next((old for old in stated if old.target == limit.target and _is_wider(old, limit)), None)
    if widened is None:
        return None
    return f"the limit {format_bounds(widened.lower, widened.upper)} of the library is widened"


def name_limit(limit: Limit) -> str:
    """Name of a limit: its quantity and item, and its pantograph if it has one."""
    return name_value(limit.quantity, limit.item) + (f" of pantograph {limit.owner}" if limit.owner else "")


def _is_wider(stated: Limit, limit: Limit | Requirement) -> bool:
    lower = stated.lower is not None and (limit.lower is None or limit.lower < stated.lower)
    upper = stated.upper is not None and (limit.upper is None or limit.upper > stated.upper)
    return lower or upper
