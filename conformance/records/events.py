"""Events of a record: stretches of the line, from the sidecar or from a channel of the file."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import EventKind

MOST_EVENTS = 10_000
"""Largest number of events of a channel; noise around the level gives more."""


@dataclass(frozen=True)
class RecordEvent:
    """Stretch of the line."""

    kind: EventKind
    """Kind of the place."""
    name: str
    """Name of the place; empty if it has none."""
    start: float
    end: float
    """Ends of the stretch in running direction [m]; equal for a place."""
    reason: str | None
    """Stated reason to leave the stretch out of the evaluation; None: it is evaluated."""


class TooManyEvents(ValueError):
    """A channel of events with more events than a line has: its level lies in noise."""


def list_events(sidecar: RecordSidecar, position: RealArray, levels: RealArray | None) -> tuple[RecordEvent, ...]:
    """Events of a record in running direction.

    Args:
        sidecar: Sidecar with its events.
        position: Position of the first pantograph, (n,) [m].
        levels: Channels of events, in the order of the sidecar, (k, n).

    Raises:
        TooManyEvents: A channel marks too many events.
    """
    events = [*_list_stated(sidecar)]
    for channel, level in zip(sidecar.event_channel, () if levels is None else levels, strict=True):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], level > channel.above, [False]]).astype(np.int8)))
        if edges.size > 2 * MOST_EVENTS:
            raise TooManyEvents(f"the column {channel.column[:80]!r} marks more than {MOST_EVENTS} events")
        for first, after in edges.reshape(-1, 2):
            start, end = (float(position[i]) + channel.ahead_m for i in (first, after - 1))
            events.append(RecordEvent(channel.kind, "", start, end, channel.exclude))
    return tuple(sorted(events, key=lambda event: (event.start, event.end)))


def _list_stated(sidecar: RecordSidecar) -> Iterator[RecordEvent]:
    for event in sidecar.event:
        if event.from_m is not None:
            ends = [event.from_m, event.from_m if event.to_m is None else event.to_m]
        else:
            assert event.from_km is not None  # checked by the sidecar
            assert sidecar.track is not None
            to_km = event.from_km if event.to_km is None else event.to_km
            ends = sorted(map(sidecar.track.place, (event.from_km, to_km)))
        yield RecordEvent(event.kind, event.name, ends[0], ends[1], event.exclude)


def covered_share(stretches: Sequence[tuple[float, float]], section: tuple[float, float]) -> float:
    """Share of a section that lies inside stretches, which may overlap [-]; ends [m]."""
    begin, end = section
    covered, reached = 0.0, begin
    for start, stop in sorted(stretches):
        low, high = max(start, reached), min(stop, end)
        if high > low:
            covered += high - low
            reached = high
    return covered / (end - begin)
