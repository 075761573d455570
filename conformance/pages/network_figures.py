"""Figures of measured lines: line diagram by kilometre, map by the coordinates of places, force at a worst place."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_style import (
    CROSS,
    FULL,
    INK,
    VERDICT_COLOURS,
    add_legend,
    new_figure,
    render_svg,
)
from pantocheck.conformance.core.verdicts import WORST_FIRST
from pantocheck.conformance.results.network_format import ForcePlace, NetworkResults, SectionGroup, TrackSection

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EARTH_KM = 6371.0
"""Mean radius of the Earth [km]."""

LONGEST_STEP_KM = 0.25
"""Largest distance of two points of a drawn section [km]."""

VERDICT_WIDTHS = {"error": 3.0, "fail": 3.0, "skip": 1.0}
"""Widths of the lines of verdicts that are not drawn in the common width [pt]."""

VERDICT_HEIGHTS = {"error": 1.0, "fail": 1.0, "skip": 0.6}
"""Heights of these verdicts in the strip of a line diagram [-]; the others are lower."""

TrackLines = Mapping[tuple[str, str], RealArray]
"""Kilometre, latitude and longitude of the known places of each track, (n, 3) [km, deg, deg]."""


def list_coordinates(results: NetworkResults) -> TrackLines:
    """Coordinates of the tracks with two located places or more."""
    found = defaultdict[tuple[str, str], dict[float, tuple[float, float]]](dict)
    for place in results.known_places:
        if place.latitude_deg is not None and place.longitude_deg is not None:
            found[place.line, place.track][place.from_km] = (place.latitude_deg, place.longitude_deg)
    return {
        track: np.array([(km, *place) for km, place in sorted(places.items())])
        for track, places in found.items()
        if len(places) > 1
    }


@render_svg
def draw_track(groups: Sequence[SectionGroup]) -> "Figure":
    """Line diagram: mean force of the sections of a track by kilometre, above a strip of their worst verdicts."""
    figure = new_figure(FULL, 2.3)
    force, strip = figure.subplots(2, sharex=True, height_ratios=(5, 1))
    known = [group for group in groups if "mean_force_N" in group.values]
    middles = [(group.section.from_km + group.section.to_km) / 2 for group in known]
    values = [group.values["mean_force_N"] for group in known]
    ranges = [[value.mean - value.lowest for value in values], [value.highest - value.mean for value in values]]
    force.errorbar(middles, [value.mean for value in values], ranges, fmt=".", color=INK, markersize=2, elinewidth=0.5)
    force.set_ylabel("mean force [N]")
    force.set_ylim(0, 1.1 * max((value.highest for value in values), default=1.0))
    verdicts = _list_verdicts(groups)
    for verdict in dict.fromkeys(sorted(verdicts.values(), key=WORST_FIRST.index)):
        spans = [(x.from_km, x.to_km - x.from_km) for x, own in verdicts.items() if own == verdict]
        height = VERDICT_HEIGHTS.get(verdict, 0.3)
        strip.broken_barh(spans, (0, height), color=VERDICT_COLOURS[verdict], linewidth=0.8, label=verdict)
    strip.set(xlabel="kilometre", ylim=(0, 1.05), yticks=[])
    handles = strip.get_legend_handles_labels()
    force.legend(*handles, loc="lower left", bbox_to_anchor=(0, 1.02), ncols=8, borderaxespad=0.2)
    return figure


@render_svg
def draw_network_map(results: NetworkResults, tracks: TrackLines) -> "Figure":
    """Sections in the colour and width of their worst verdict, as far as their ends lie between located places."""
    from matplotlib.collections import LineCollection

    figure = new_figure(FULL, 4.5)
    axes = figure.subplots()
    middle = np.concatenate(list(tracks.values()))[:, 1:].mean(axis=0)
    shapes = defaultdict[str, list[RealArray]](list)
    for section, verdict in _list_verdicts(results.groups).items():
        points = _locate(tracks, section.line, section.track, _list_kilometres(section), middle)
        if np.isfinite(points).all():
            shapes[verdict].append(points)
    for verdict in WORST_FIRST[::-1]:
        if shapes[verdict]:
            width, colour = VERDICT_WIDTHS.get(verdict, 1.8), VERDICT_COLOURS[verdict]
            axes.add_collection(LineCollection(shapes[verdict], linewidths=width, colors=colour, label=verdict))
    places = [(x.line, x.track, np.array([x.km])) for x in results.places if x.trace is not None and not x.explained]
    crosses = np.array([_locate(tracks, *place, middle)[0] for place in places]).reshape(-1, 2)
    if np.isfinite(crosses).any():
        axes.plot(*crosses.T, "x", color=CROSS, markersize=6, label="worst place")
    for (line, track), located in tracks.items():
        start = _project(located[:1, 1:], middle)[0]
        axes.annotate(f"{line}, {track}", start, xytext=(4, 4), textcoords="offset points", fontsize=6.5, color=INK)
    axes.set(xlabel="to the east [km]", ylabel="to the north [km]")
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    if axes.get_legend_handles_labels()[0]:
        add_legend(axes)
    return figure


WIDTH, HEIGHT, LEFT, TOP, BASE = 340, 130, 34, 8, 108
"""Size of the figure of a trace, and place of its axes [px]."""


def draw_trace(place: ForcePlace) -> str:
    """SVG of the force around a place, with the place as a dashed line.

    A figure of its own, written here: a hundred of them take a second in place of twenty.
    """
    assert place.trace is not None  # chosen by the caller
    km, force = np.array(place.trace.x), np.array(place.trace.y)
    low, high = min(0.0, float(force.min())), float(force.max())
    x = LEFT + (WIDTH - LEFT - 8) * (km - km[0]) / max(float(np.ptp(km)), 1e-9)
    y = BASE - (BASE - TOP) * (force - low) / max(high - low, 1e-9)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    mark = float(np.interp(place.km, km, x))
    label = f'fill="{INK}" font-size="9" font-family="sans-serif"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">'
        f'<path d="M{LEFT} {TOP}V{BASE}H{WIDTH - 8}" fill="none" stroke="{INK}" stroke-width="0.7"/>'
        f'<path d="M{mark:.1f} {TOP}V{BASE}" stroke="{CROSS}" stroke-width="1" stroke-dasharray="4 3"/>'
        f'<polyline points="{points}" fill="none" stroke="{INK}" stroke-width="1.1"/>'
        f'<text x="{LEFT - 4}" y="{TOP + 6}" text-anchor="end" {label}>{high:.0f} N</text>'
        f'<text x="{LEFT - 4}" y="{BASE}" text-anchor="end" {label}>{low:.0f} N</text>'
        f'<text x="{LEFT}" y="{BASE + 14}" {label}>{km[0]:.3f} km</text>'
        f'<text x="{WIDTH - 8}" y="{BASE + 14}" text-anchor="end" {label}>{km[-1]:.3f} km</text></svg>'
    )


def _list_verdicts(groups: Sequence[SectionGroup]) -> dict[TrackSection, str]:
    """Worst verdict of the groups of each section."""
    found: dict[TrackSection, str] = {}
    for group in groups:
        verdicts = (group.verdict, found.get(group.section, group.verdict))
        found[group.section] = min(verdicts, key=WORST_FIRST.index)
    return found


def _list_kilometres(section: TrackSection) -> RealArray:
    count = int(np.ceil((section.to_km - section.from_km) / LONGEST_STEP_KM)) + 1
    return np.linspace(section.from_km, section.to_km, max(2, count))


def _locate(tracks: TrackLines, line: str, track: str, km: RealArray, middle: Sequence[float] | RealArray) -> RealArray:
    """Points of a track on the map, (n, 2) [km]; NaN outside of its located places."""
    located = tracks.get((line, track))
    if located is None:
        return np.full((km.size, 2), np.nan)
    columns = (np.interp(km, located[:, 0], located[:, i], left=np.nan, right=np.nan) for i in (1, 2))
    return _project(np.column_stack(list(columns)), middle)


def _project(degrees: RealArray, middle: Sequence[float] | RealArray) -> RealArray:
    """East and north of the middle on a cylinder that is true to scale there, (n, 2) [km]."""
    north, east = np.radians(degrees - middle).T
    return EARTH_KM * np.column_stack([np.cos(np.radians(middle[0])) * east, north])
