"""Parts of the guide: name and computation of each, in the order of the guide."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.core.results_part import ResultsPart
from pantocheck.conformance.line.library_folder import library_folder
from verification.guide.guide_format import LibraryCase, PeerComparison, Performance, SelfTestSummary, Topic
from verification.guide.library_values import compute_library_case
from verification.guide.peers.peer_list import PEERS
from verification.guide.peers.peer_package import find_version, run_peer
from verification.guide.performance import measure_performance, name_processor
from verification.guide.self_test_summary import summarise_self_test
from verification.guide.topics.long_string_passage import study_long_string
from verification.guide.topics.moving_load import study_moving_load
from verification.guide.topics.passage_balance import study_balances
from verification.guide.topics.string_droppers import study_dropper_lengths
from verification.guide.topics.time_integration import study_time_integration
from verification.guide.topics.wire_at_rest import study_elasticity, study_sag
from verification.guide.topics.wire_modes import study_frequencies
from verification.guide.topics.wire_waves import study_waves

TOPICS: dict[str, Callable[[], Topic]] = {
    "wire-sag": study_sag,
    "wire-elasticity": study_elasticity,
    "wire-frequencies": study_frequencies,
    "dropper-lengths": study_dropper_lengths,
    "waves": study_waves,
    "time-integration": study_time_integration,
    "moving-load": study_moving_load,
    "long-string": study_long_string,
    "balances": study_balances,
}
"""Topics of the verification against closed forms."""


@dataclass(frozen=True)
class GuideTask:
    """Part of the guide."""

    name: str
    """Section and name within it."""
    content: type[ResultsPart]
    """Type of the content."""
    compute: Callable[[], ResultsPart]
    """Computation of the content; it can be sent to another process."""
    subject: str = ""
    """Further part of its identity, such as the installed version of a peer: with another one it is computed again."""


def list_tasks() -> list[GuideTask]:
    """Parts of the guide that can be computed side by side, the longest first."""
    topics = [GuideTask(f"verification/{name}", Topic, study) for name, study in TOPICS.items()]
    cases = [
        GuideTask(f"library/{name}", LibraryCase, partial(compute_library_case, name))
        for name in list_library(library_folder())
    ]
    peers = [
        GuideTask(f"peers/{name}", PeerComparison, partial(run_installed_peer, name), find_version(peer.package) or "")
        for name, peer in PEERS.items()
    ]
    return [GuideTask("self-test/all", SelfTestSummary, summarise_self_test), *topics, *cases, *peers]


def run_installed_peer(name: str) -> PeerComparison:
    """Comparison with a package of others by its name."""
    return run_peer(PEERS[name])


def list_timings() -> list[GuideTask]:
    """Parts that are computed alone, because they measure times."""
    return [GuideTask("performance/all", Performance, measure_performance, name_processor())]
