"""Durations of the parts of the guide, which weight its progress: one process on one core, once measured."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.results_part import ResultsPart
from pantocheck.conformance.line.library_folder import library_folder
from verification.guide.guide_format import LibraryCase, PeerComparison, Performance, SelfTestSummary, Topic
from verification.guide.library_values import (
    compute_library_case,
    measure_performance,
    name_processor,
    summarise_self_test,
)
from verification.guide.peers.peer_list import PEERS, find_version, run_peer
from verification.guide.topics.contact_laws import study_contact_laws
from verification.guide.topics.line_elements import study_line_elements
from verification.guide.topics.long_string_passage import study_long_string
from verification.guide.topics.moving_load import study_moving_load
from verification.guide.topics.passage_balance import study_balances
from verification.guide.topics.string_droppers import study_dropper_lengths
from verification.guide.topics.time_integration import study_time_integration
from verification.guide.topics.wire_at_rest import study_elasticity, study_sag
from verification.guide.topics.wire_modes import study_frequencies
from verification.guide.topics.wire_waves import study_waves

DURATIONS_S = {
    "self-test/all": 240.0,
    "verification/waves": 10.0,
    "verification/long-string": 25.0,
    "verification/contact-laws": 30.0,
    "verification/line-elements": 25.0,
    "library/en50318-2018/ac-simple/275": 35.0,
    "library/en50318-2018/ac-simple/275-twin": 35.0,
    "library/en50318-2018/ac-simple/320": 35.0,
    "library/en50318-2018/ac-simple/320-twin": 35.0,
    "library/en50318-2018/ac-stitched/275": 123.0,
    "library/en50318-2018/ac-stitched/320": 74.0,
    "library/force-law/300": 37.0,
    "library/generic/direct-current/160": 30.0,
    "library/generic/twin-contact/200": 30.0,
    "library/generic/two-strips": 35.0,
    "library/vovan2015/contact-force": 63.0,
    "library/vovan2015/dropper-damping": 30.0,
    "library/vovan2015/mass-drop/printed": 24.0,
    "library/vovan2015/mass-drop/stand-in": 99.0,
    "library/vovan2015/release-velocity": 21.0,
    "library/vovan2015/steady-arm-damper": 66.0,
    "performance/all": 41.0,
}
"""Durations of the long parts [s]."""

SHORT_DURATION_S = 2.0
"""Duration of every other part [s]."""


def sum_durations(parts: Iterable[str]) -> float:
    """Estimated duration of parts [s]."""
    return sum(DURATIONS_S.get(part, SHORT_DURATION_S) for part in parts)


# Parts of the guide: name and computation of each, in the order of the guide.
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
    "contact-laws": study_contact_laws,
    "line-elements": study_line_elements,
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


# Finished parts of a guide as files, so that an interrupted guide continues.
FOLDER_OF_PARTS = "parts"
"""Folder of the finished parts in that of the guide."""


@dataclass(frozen=True)
class GuideStore:
    """Folder of finished parts."""

    folder: Path
    """Folder of the guide."""
    identity: str
    """Suite and platform of the guide; parts of another one are computed again."""

    def read(self, task: GuideTask) -> ResultsPart | None:
        """Content of a finished part of this suite and platform; None if there is none."""
        try:
            stored = json.loads(self._path(task).read_text("utf-8"))
            if stored["identity"] != self._identify(task):
                return None
            return task.content.model_validate(stored["content"])
        except (OSError, ValueError, KeyError, TypeError, ValidationError):
            return None  # absent, damaged or of another format: the part is computed again

    def write(self, task: GuideTask, content: ResultsPart) -> None:
        """Store a finished part.

        Raises:
            InputError: The file cannot be written.
        """
        stored = {"identity": self._identify(task), "content": content.model_dump(mode="json", by_alias=True)}
        write_atomically(self._path(task), json.dumps(stored, allow_nan=False).encode("ascii"))

    def _identify(self, task: GuideTask) -> str:
        return f"{self.identity} {task.subject}"

    def _path(self, task: GuideTask) -> Path:
        return self.folder / FOLDER_OF_PARTS / f"{task.name.replace('/', '--')}.json"
