"""Building of results.json: overall verdict, versions and platform."""

import math
import platform as host
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from typing import TypeVar

from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.decision import format_decision
from pantocheck.conformance.core.findings import count_findings
from pantocheck.conformance.core.results_part import Number, Suite
from pantocheck.conformance.core.suite_identity import find_suite_commit, suite_digest
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.case_verdict import EVERY_CASE, Participation
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.uncertainty import Uncertainty
from pantocheck.conformance.results.procedure_format import Procedure
from pantocheck.conformance.results.renderer_identity import identify_renderer
from pantocheck.conformance.results.results_format import (
    CaseResult,
    Platform,
    Results,
    SystemIdentity,
    UncertaintyComponents,
)
from pantocheck.conformance.results.scope import build_scope
from pantocheck.model.dynamics.core_choice import core_name

Content = TypeVar("Content")


TIME_FORMAT = "%Y-%m-%dT%H:%M:%SZ"
"""Format of the start of a run, in UTC."""


def utc_now() -> str:
    """Current time in the format of results.json."""
    return datetime.now(UTC).strftime(TIME_FORMAT)


def key_by_owner(parts: Mapping[int, Mapping[str, Content]]) -> dict[str, dict[str, Content]]:
    """Parts of a result by the number of the pantograph as text; owners without content are left out."""
    return {str(owner): dict(content) for owner, content in parts.items() if content}


def select_finite(values: Mapping[int, Mapping[str, Value]]) -> dict[int, dict[str, Number]]:
    """Finite values in the types of results.json; a quantity with a non-finite number is left out."""
    return {
        owner: {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in quantities.items()
            if all(map(math.isfinite, value if isinstance(value, tuple) else (value,)))
        }
        for owner, quantities in values.items()
    }


def list_components(uncertainty: Uncertainty) -> UncertaintyComponents:
    """Half-widths of the components of an uncertainty in the types of results.json."""
    components: dict[int, dict[str, dict[ComponentName, Number]]] = {
        owner: {
            name: {part: list(width) if isinstance(width, tuple) else width for part, width in parts.items()}
            for name, parts in quantities.items()
        }
        for owner, quantities in uncertainty.by_quantity.items()
    }
    return key_by_owner(components)


def build_suite() -> Suite:
    """Identity of the installed suite."""
    return Suite(version=version("pantocheck"), commit=find_suite_commit(), digest=suite_digest())


def build_results(
    cases: Sequence[CaseResult],
    system: SystemIdentity,
    trust: Trust,
    started: str,
    participation: Participation = EVERY_CASE,
    procedure: Procedure | None = None,
) -> Results:
    """Combine the results of cases.

    Args:
        cases: Results of the cases, in the order of reports.
        system: Graded system.
        trust: Lowest trust of the limits that count.
        started: Start of the run, from `utc_now`.
        participation: Cases and verdicts that decide the verdict of the run, and accepted unconfirmed records.
        procedure: Steps of a dossier, whose verdicts follow from those of the cases; None: no dossier.
    """
    results = Results(
        suite=build_suite(),
        system=system,
        verdict="info",
        criteria_verdict=None,
        trust=trust,
        decision=format_decision(participation.decision),
        started=started,
        platform=Platform(
            python=host.python_version(),
            numpy=version("numpy"),
            scipy=version("scipy"),
            core=core_name(),
            machine=host.machine(),
            system=host.system(),
        ),
        renderer=identify_renderer(),
        scope=build_scope(cases),
        findings=count_findings(row.finding for case in cases for row in case.criteria),
        procedure=procedure,
        cases=list(cases),
    )
    return participation.decide_run(results)
