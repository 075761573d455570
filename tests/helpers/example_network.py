"""Assessed collection of 5,000 km: ten lines on a map, two classes of speed, and 100 worst places."""

import datetime

import numpy as np

from pantocheck.conformance.core.figure_data import Series
from pantocheck.conformance.core.results_part import Suite
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.network_format import (
    ForcePlace,
    KnownPlace,
    NetworkResults,
    RepeatedValue,
    SectionGroup,
    TrackSection,
)

LINES, LENGTH_KM = 10, 500
FAILING, SKIPPED = 50, 7
"""Every 50th kilometre fails in the higher class of speed; a line has no passage over its first seven."""


def build_network() -> NetworkResults:
    """Results of ten lines of 500 km with sections of 1 km, in two classes of speed with dates of their own."""
    groups = [
        build_group(str(line), km, speed)
        for line in range(LINES)
        for km in range(LENGTH_KM)
        for speed in (250.0, 270.0)
    ]
    return NetworkResults(
        suite=Suite(version="0.1.0", commit=None, digest="sha256:" + "0" * 64),
        profile="acceptance-ac",
        trust="secondary",
        by=("section", "speed"),
        verdict="fail",
        reason="some sections fail",
        runs=2 * LINES,
        passages=2 * LINES * LENGTH_KM,
        measured_km=float(LINES * (LENGTH_KM - SKIPPED)),
        total_km=float(LINES * LENGTH_KM),
        groups=tuple(groups),
        places=tuple(build_place(number) for number in range(100)),
        misplaced=(),
        unusual=(),
        known_places=tuple(locate(line, km) for line in range(LINES) for km in range(0, LENGTH_KM + 1, 5)),
        refused=(),
        suspicious={},
    )


def build_group(line: str, km: int, speed: float) -> SectionGroup:
    """Group of one section: measured on the 1st to the 9th of May, or of June in the higher class of speed."""
    known, month = km >= SKIPPED, 5 if speed < 260 else 6
    failed = known and speed > 260 and km % FAILING == 0
    verdict: Verdict = "fail" if failed else "pass" if known else "skip"
    mean = 120.0 + 5 * float(np.sin(km / 20))
    value = RepeatedValue(
        passages=3, mean=mean, lowest=mean - 2, highest=mean + 2, spread=1.0, mean_range=2.5,
        drift=None, drifts=False,
    )  # fmt: skip
    return SectionGroup(
        section=TrackSection(line=line, track="1", name="", from_km=float(km), to_km=km + 1.0),
        speed_km_h=(speed, speed + 10),
        direction=None,
        pantograph=None,
        verdict=verdict,
        reason="" if verdict == "pass" else "contact_loss_pct: too high" if failed else "no run measured it",
        passages=3 if known else 0,
        partial=0,
        dates=(datetime.date(2026, month, 1), datetime.date(2026, month, 9)) if known else (),
        run=f"{line}-{month}" if known else None,
        values={"mean_force_N": value} if known else {},
    )


def build_place(number: int) -> ForcePlace:
    """One of the worst places: ten of each line, every 50 km."""
    line, km = str(number // 10), 25.0 + 50 * (number % 10)
    x = km + np.linspace(-0.08, 0.08, 300)
    force = 120 + 30 * np.cos(x * 2 * np.pi / 0.055) - 80 * np.exp(-(((x - km) / 0.004) ** 2))
    trace = Series(label="filtered force", style="line", x=x.round(5).tolist(), y=force.round(2).tolist())
    return ForcePlace(
        line=line, track="1", km=km, run=f"{line}-6", date=datetime.date(2026, 6, 1), direction="increasing",
        pantograph="1", force_N=70.0, deviation=-20.0 + number / 10, threshold=5.5, extent_m=3.0, found=3, passages=3,
        place="", explained=number % 2 == 1, trace=trace,
    )  # fmt: skip


def locate(line: int, km: int) -> KnownPlace:
    """Support of a line that runs to the north-east from its own start."""
    place = {"latitude_deg": 47.0 + 0.4 * line + 0.006 * km, "longitude_deg": 8.0 + 0.008 * km}
    return KnownPlace(line=str(line), track="1", kind="support", name=str(km), from_km=km, to_km=km, **place)
