"""Other starts and other analysis sections of a case, with which the uncertainty of its results is determined.

After a short run-in, the response to the start is still part of the results. Runs with other starts determine it. After
a long run-in, the same run contains earlier sections with a shorter run-in.
"""

from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.cases.case import Case

SHORT_RUN_IN_SPANS = 10.0
"""Run-in below which the response to the start is part of the results: the forces settle within 10 to 30 spans."""

START_SHIFTS = (-2 / 3, -1 / 3, 1 / 3, 2 / 3, 1.0)
"""Shifts of the start in spans."""

RAMP_SHARES = (0.25, 0.5)
"""Duration of the ramps of the contact force, as a share of the time of the run-in."""

SMALLEST_SHARE_OF_RUN_IN = 0.5
"""Share of the run-in that remains before the earliest section that is compared."""

SECTION_SHIFTS = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)
"""Shifts of the analysis section in spans."""


@dataclass(frozen=True)
class RunStart:
    """Start of a run."""

    case: Case
    """The case with its start position."""
    ramp_s: float = 0.0
    """Time over which the contact force rises from zero [s]; zero: the static force acts from the start."""


def run_in_spans(case: Case) -> float:
    """Distance that the first pantograph runs before the analysis section, in spans of the section."""
    return (case.analysis_section[0] - case.start_positions[0]) / span_length(case)


def has_short_run_in(case: Case) -> bool:
    """Whether the response to the start is still part of the results."""
    return run_in_spans(case) < SHORT_RUN_IN_SPANS


def list_other_starts(case: Case) -> tuple[RunStart, ...]:
    """Other starts of a case with a short run-in; none after a long run-in.

    The start is shifted along the line, and the contact force of the stated start rises over a ramp. A shifted start
    stays on the line and outside of overlaps, and every pantograph starts before the analysis section.
    """
    if not has_short_run_in(case):
        return ()
    span, run_in = span_length(case), case.analysis_section[0] - case.start_positions[0]
    shifts = [share * span for share in START_SHIFTS if case.start + share * span > 0 and share * span < run_in]
    cases = [replace(case, file=case.file.model_copy(update={"start_m": case.start + shift})) for shift in shifts]
    shifted = (RunStart(other) for other in cases if not _starts_in_overlap(other))
    ramps = (RunStart(case, share * run_in / case.speed) for share in RAMP_SHARES if run_in > 0)
    return (*shifted, *ramps)


def _starts_in_overlap(case: Case) -> bool:
    return any(start < x < end for x in case.start_positions for start, end in case.line.overlaps)


def list_earlier_sections(case: Case) -> tuple[tuple[float, float], ...]:
    """Analysis section shifted back by whole spans, up to half of the run-in [m, m].

    After a short run-in, no earlier section is settled: only the sections that the case itself compares are returned.
    """
    if has_short_run_in(case):
        return case.shifted_sections
    farthest = int((1 - SMALLEST_SHARE_OF_RUN_IN) * run_in_spans(case))
    if case.file.evaluated_m is not None:
        (start, end), span = case.file.evaluated_m, span_length(case)
        return tuple((start - k * span, end - k * span) for k in range(1, farthest + 1))
    first, last = case.analysed_spans
    return tuple(case.line.geometry.section(first - k, last - k) for k in range(1, farthest + 1))


def shift_section(section: tuple[float, float], span_m: float) -> tuple[tuple[float, float], ...]:
    """Section shifted by fractions of a span [m, m]; section and length of a span in [m]."""
    start, end = section
    return tuple((start + share * span_m, end + share * span_m) for share in SECTION_SHIFTS)


def span_length(case: Case) -> float:
    """Mean length of the spans of the analysis section [m]."""
    first, last = case.analysed_spans
    return float(np.mean(case.line.geometry.span_lengths[first - 1 : last]))
