"""Guide from its parts, with the stamps of suite and platform."""

import platform as host
from importlib.metadata import version
from typing import TypeVar

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.core.results_part import ResultsPart
from pantocheck.conformance.grading.results_building import build_suite, utc_now
from pantocheck.conformance.results.results_format import Platform
from pantocheck.conformance.runs.resolution import read_effects
from pantocheck.model.dynamics.core_choice import core_name
from verification.guide.guide_driver import GuideParts, read_limitations
from verification.guide.guide_format import (
    Guide,
    LibraryCase,
    PeerComparison,
    Performance,
    SelfTestSummary,
    StoredEffect,
    Topic,
)

Part = TypeVar("Part", bound=ResultsPart)


def describe_platform() -> Platform:
    """Platform of this process."""
    return Platform(
        python=host.python_version(),
        numpy=version("numpy"),
        scipy=version("scipy"),
        core=core_name(),
        machine=host.machine(),
        system=host.system(),
    )


def guide_identity() -> str:
    """Suite and platform on which a part of the guide depends."""
    suite = build_suite()
    return f"{suite.version} {suite.digest} {describe_platform().model_dump_json()}"


def build_guide(parts: GuideParts) -> Guide:
    """Guide from its finished and failed parts."""
    return Guide(
        suite=build_suite(),
        platform=describe_platform(),
        created=utc_now(),
        verification=_select(parts, "verification", Topic),
        library=list(_select(parts, "library", LibraryCase).values()),
        effects=list_effects(),
        peers=list(_select(parts, "peers", PeerComparison).values()),
        self_test=_select(parts, "self-test", SelfTestSummary).get("all"),
        performance=_select(parts, "performance", Performance).get("all"),
        limitations=read_limitations(),
        failed=parts.failed,
    )


def list_effects() -> list[StoredEffect]:
    """Stored differences from the exact three-dimensional model."""
    return [
        StoredEffect(
            effect=effect.effect,
            compared=effect.compared,
            source=source_text(effect.source),
            relative_pct=effect.relative_pct,
            absolute=effect.absolute,
        )
        for effect in read_effects()
        if effect.source == "exact_model"
    ]


def list_deviations(guide: Guide) -> list[str]:
    """Names of comparisons outside their tolerance, orders outside their range, and failed parts."""
    found: list[str] = []
    for name, topic in guide.verification.items():
        found += [f"verification/{name}/{row.key}" for row in topic.comparisons if not row.agrees]
        found += [f"verification/{name}/{row.key}" for row in topic.convergence if not row.agrees]
    found += [
        f"library/{case.case}/{row.pantograph}/{row.quantity}"
        for case in guide.library
        for row in case.converged
        if not row.inside
    ]
    found += [f"peers/{peer.package}/{row.key}" for peer in guide.peers for row in peer.comparisons if not row.agrees]
    if guide.self_test is not None:
        faults = (*guide.self_test.records, *guide.self_test.numerical)
        found += [f"self-test/{row.name}/{row.case}" for row in faults if row.must_be_detected and not row.detected]
        found += [
            f"self-test/reference/{name}" for name, verdict in guide.self_test.reference.items() if verdict != "pass"
        ]
    return found + [part.part for part in guide.failed]


def _select(parts: GuideParts, section: str, content: type[Part]) -> dict[str, Part]:
    prefix = f"{section}/"
    return {
        name.removeprefix(prefix): part
        for name, part in parts.contents.items()
        if name.startswith(prefix) and isinstance(part, content)
    }
