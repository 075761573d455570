"""Format of network.json: sections of measured railway lines with their verdicts, and the worst places."""

import datetime
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.figure_data import Series
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart, Suite
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict

Direction = Literal["increasing", "decreasing"]
"""Kilometres in running direction."""

GroupKey = Literal["section", "speed", "direction", "pantograph"]
"""Property by which the passages of a line and track are grouped."""


class TrackSection(ResultsPart):
    """Section of a track that is graded."""

    line: str
    track: str
    name: str
    """Name of a tension section; empty for a stretch between two kilometres."""
    from_km: FiniteNumber
    to_km: FiniteNumber
    """Ends; the first has the lower kilometre."""


class SectionPassage(ResultsPart):
    """Passage of one pantograph over one section in one run."""

    section: TrackSection
    run: str
    date: datetime.date
    direction: Direction
    pantograph: str
    """Name, or number in running order."""
    speed_km_h: FiniteNumber | None
    """Mean speed over the section; null: one of its ends was not passed."""
    whole: bool
    """Whether the run states that it measured the whole section."""
    verdict: Verdict
    reason: str
    """Reasons of criteria that do not pass; empty if all do."""
    values: dict[str, FiniteNumber]
    """Quantities in the units of their names."""
    clocks: str = ""
    """Further sources of the run with the state of their clocks; empty without one at a support of the section."""


class RepeatedValue(ResultsPart):
    """One quantity over the passages of a group."""

    passages: int
    mean: FiniteNumber
    lowest: FiniteNumber
    highest: FiniteNumber
    spread: FiniteNumber | None
    """Standard deviation over the passages; null: one passage."""
    mean_range: FiniteNumber | None
    """Half the range of the mean, by Student's t with 95 %; its coverage is not measured. Null: one passage."""
    drift: FiniteNumber | None
    """Change from the first to the last date, by a straight line; null: fewer than four passages or three dates."""
    drifts: bool
    """Whether the change exceeds its own range, by Student's t with 99 %."""


class SectionGroup(ResultsPart):
    """Passages over a section that belong together, with one verdict."""

    section: TrackSection
    speed_km_h: tuple[FiniteNumber, FiniteNumber] | None
    """Class of the speed; null: every speed."""
    direction: Direction | None
    pantograph: str | None
    verdict: Verdict
    """Worst of the passages over the whole section; `skip` without any."""
    reason: str
    passages: int
    """Passages over the whole section."""
    partial: int
    """Further passages over a part of it, which do not count."""
    dates: tuple[datetime.date, ...]
    """First and last date; empty without a passage."""
    run: str | None
    """Run of the worst passage, or of the first of several; null: no passage."""
    values: dict[str, RepeatedValue]
    clocks: str = ""
    """States of the clocks of further sources in these passages, each once; empty without one."""


class KnownPlace(ResultsPart):
    """Place of a track with a name, from a table of assets."""

    line: str
    track: str
    kind: str
    name: str
    from_km: FiniteNumber
    to_km: FiniteNumber
    latitude_deg: FiniteNumber | None = None
    longitude_deg: FiniteNumber | None = None
    """Coordinates of its first end for the map; null: not known."""


class ForcePlace(ResultsPart):
    """Place where the force differs from that of the neighbouring spans, in one run or several."""

    line: str
    track: str
    km: FiniteNumber
    run: str
    """Run with the largest deviation."""
    date: datetime.date
    direction: Direction
    pantograph: str
    force_N: FiniteNumber
    """Filtered force."""
    deviation: FiniteNumber
    """Mean difference from the neighbouring spans over the extent, in robust standard deviations of such means."""
    threshold: FiniteNumber
    """Deviation from which a place is listed."""
    extent_m: FiniteNumber
    found: int
    """Passages that show the deviation by themselves; 0: only the mean of several shows it."""
    passages: int
    """Passages over the place."""
    place: str
    """Nearest known place; empty if none is near."""
    explained: bool
    """Whether the place is an overlap, section insulator, neutral section or switch."""
    trace: Series | None = None
    """Filtered force by kilometre around the place; null outside the worst places."""


class MisplacedRun(ResultsPart):
    """Stretch of a run whose force is not that of the other passages at the same kilometre."""

    line: str
    track: str
    run: str
    pantograph: str
    from_km: FiniteNumber
    to_km: FiniteNumber
    offset_m: FiniteNumber | None
    """Kilometre of this run less that of the others at the same force; null: it agrees with them nowhere."""
    offset_s: FiniteNumber | None
    """Error of a clock that explains the offset."""
    agreement: FiniteNumber
    """Correlation with the mean of the others at this offset [-]."""


class UnusualValue(ResultsPart):
    """Value of a section that differs from the others of its track, or of a passage from those of its section."""

    section: TrackSection
    speed_km_h: tuple[FiniteNumber, FiniteNumber] | None
    run: str | None
    """Run of an unusual passage; null: the median of all passages of the section is unusual."""
    quantity: str
    value: FiniteNumber
    expected: FiniteNumber
    """Median of the others."""
    deviation: FiniteNumber
    """Difference in robust standard deviations."""


class RefusedImport(ResultsPart):
    """File that could not be imported."""

    file: str
    reason: str


class NetworkResults(ResultsPart):
    """Assessment of a collection of runs."""

    schema_: Annotated[Literal["pantocheck.network/1"], Field(alias="schema")] = "pantocheck.network/1"
    suite: Suite
    profile: str
    trust: Trust
    """Lowest trust of the rules that count."""
    by: tuple[GroupKey, ...]
    verdict: Verdict
    reason: str
    runs: int
    passages: int
    measured_km: FiniteNumber
    """Length of the sections with a passage over their whole length."""
    total_km: FiniteNumber
    """Length of all sections."""
    groups: tuple[SectionGroup, ...]
    places: tuple[ForcePlace, ...]
    """From the largest deviation over its threshold to the smallest."""
    misplaced: tuple[MisplacedRun, ...]
    unusual: tuple[UnusualValue, ...]
    known_places: tuple[KnownPlace, ...]
    refused: tuple[RefusedImport, ...]
    suspicious: dict[str, tuple[str, ...]]
    """Remarks on imported runs."""
