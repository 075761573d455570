"""From the results of cases to results.json: the verdict of the whole, and what it was computed with."""

import platform as host
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version

from pantocheck.conformance.grading.verdicts import worst_verdict
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.results.results_format import CaseResult, Platform, Results, Suite, SystemIdentity
from pantocheck.conformance.results.suite_identity import find_suite_commit


def utc_now() -> str:
    """The time as results state it."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def build_results(cases: Sequence[CaseResult], system: SystemIdentity, trust: Trust, started: str) -> Results:
    """Results of cases.

    Parameters
    ----------
    cases : Sequence[CaseResult]
        In the order they are reported.
    system : SystemIdentity
        What was graded.
    trust : Trust
        Lowest trust of the limits that carry a verdict.
    started : str
        When, from `now`.
    """
    return Results(
        suite=Suite(version=version("pantocheck"), commit=find_suite_commit()),
        system=system,
        verdict=worst_verdict(case.verdict for case in cases),
        trust=trust,
        started=started,
        platform=Platform(
            python=host.python_version(),
            numpy=version("numpy"),
            scipy=version("scipy"),
            numba=version("numba"),
            machine=host.machine(),
            system=host.system(),
        ),
        cases=list(cases),
    )
