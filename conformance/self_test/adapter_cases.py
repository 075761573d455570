"""Cases of the adapter check: a short passage, the same with two pantographs, and its line at rest."""

from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases

BASE_CASE = "en50318-2002/250"
"""Case of the library that is shortened: a level line in one plane, one pantograph, fixed uplift force."""

SHORT_SPANS = 5
"""Spans of the short line."""

SHORT_SECTION = (3, 4)
"""Spans of the analysis section, with one span before and one behind it."""

TWIN_SPACING_M = 20.0
"""Distance of two pantographs [m]: both start before the section, and the last one runs 10 m beyond it."""


def build_short_case() -> Case:
    """Case of a few seconds: the EN 50318:2002 line at 250 km/h on five spans."""
    (case,) = select_cases([BASE_CASE])
    file = case.file.model_copy(
        update={
            "id": "check-adapter/short",
            "title": f"{case.file.title}, shortened to {SHORT_SPANS} spans",
            "evaluated_spans": SHORT_SECTION,
            "compared_spans": None,
        }
    )
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(SHORT_SPANS)})
    return replace(case, file=file, line=line)


def build_twin_case() -> Case:
    """Short case with a second pantograph of the same kind."""
    case = build_short_case()
    changes = {
        "id": "check-adapter/twin",
        "title": f"{case.file.title}, two pantographs {TWIN_SPACING_M:g} m apart",
        "pantograph": 2 * case.file.pantograph,
        "spacing_m": (TWIN_SPACING_M,),
    }
    return replace(case, file=case.file.model_copy(update=changes), pantographs=2 * case.pantographs)


def build_case_at_rest() -> Case:
    """Line of the short case without a train."""
    case = build_short_case().without_limits()
    changes = {
        "id": "check-adapter/at-rest",
        "title": f"{case.line.title}, at rest",
        "speed_km_h": None,
        "evaluated_spans": None,
        "pantograph": (),
    }
    return replace(case, file=case.file.model_copy(update=changes), pantographs=())
