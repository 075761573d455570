"""Force by frequency: a bar for each band and pantograph over its limits, with its uncertainty, and waves as its name.

|            :::::
|   :::::    :###:    :::::         ::: limits, or the converged value with its tolerance
|   :###:    :###:    :###:         ### RMS of the band
+----------------------------
     ~       ~~~~    ~~~~~~~~
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.drawn_data import DrawnData, DrawnFigure, name_panel
from pantocheck.conformance.core.figure_style import FULL, GREY, INK, LIMIT_FILL, SHADES
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES, BANDS
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.supported_frequency import find_supported_Hz

WIDTH, TOP, FOOT, HEIGHT = 72 * FULL, 16.0, 84.0, 116.0
"""Width of the figure, place of the highest bar and of the foot of the bars, and height of the figure [pt]."""

LEFT, BAR, PITCH = 44.0, 24.0, 44.0
"""Left edge of the groups, width of a bar, and distance of two bars [pt]."""

PERIODS = (1, 4, 12)
"""Periods of the waves below each band."""

MOST_BARS = 3
"""Largest number of pantographs that have room in a group."""


@dataclass(frozen=True)
class BandBar:
    """RMS of the force of a pantograph in a band [N]."""

    owner: int
    value: float
    uncertainty: float | None
    limits: tuple[float, float] | None
    supported: bool


def draw_bands(case: CaseResult) -> Iterator[doc.Figure]:
    """Figure of the bands of all pantographs of a case; none without a value."""
    owners = [key for key in sorted(case.traces, key=int) if key.isdigit()][:MOST_BARS]
    verification = [] if case.verification is None else case.verification.criteria
    published = [row for row in case.criteria if row.quantity in BAND_QUANTITIES and not row.is_drift]
    rows = published or [row for row in verification if row.quantity in BAND_QUANTITIES]
    groups = [[bar for key in owners if (bar := _find_bar(case, rows, key, n))] for n in range(len(BANDS))]
    if not any(groups):
        return
    caption = "Force by frequency: RMS of each band, with its uncertainty."
    if any(bar.limits for group in groups for bar in group):
        caption += " Grey: limits." if published else " Grey: converged value with its tolerance."
    if not all(bar.supported for group in groups for bar in group):
        caption += " Dashed: not supported by the model."
    texts = [_describe_owner(key, groups) for key in owners]
    yield doc.Figure(draw_bars(groups), " ".join((caption, *filter(None, texts))), caption)


def _describe_owner(key: str, groups: Sequence[Sequence[BandBar]]) -> str:
    """Values of a pantograph in words; empty without a value."""
    texts = [
        f"{low:g} to {high:g} Hz: {format_value(bar.value)} N"
        for (low, high, _), group in zip(BANDS, groups, strict=True)
        for bar in group
        if str(bar.owner) == key
    ]
    return f"Pantograph {key}: {'; '.join(texts)}." if texts else ""


def _find_bar(case: CaseResult, rows: Sequence[Criterion], key: str, band: int) -> BandBar | None:
    """Bar of a pantograph in a band; None without a value."""
    name, high = BANDS[band].quantity, BANDS[band].high
    value = select_single(case.quantities.get(key, {}).get(name))
    if value is None:
        return None
    found = ((row.lower, row.upper) for row in rows if row.quantity == name and str(row.pantograph) == key)
    limits = next(((low or 0.0, up) for low, up in found if up is not None), None)
    supported = find_supported_Hz(case.supported, key)
    width = select_single(case.uncertainty.get(key, {}).get(name))
    return BandBar(int(key), value, width, limits, supported is None or high <= supported)


def draw_bars(groups: Sequence[Sequence[BandBar]]) -> str:
    """SVG of the bars, in the order of `BANDS`."""
    bars = [bar for group in groups for bar in group]
    tops = [max(bar.value + (bar.uncertainty or 0), *(bar.limits or (0, 0))) for bar in bars]
    scale = (FOOT - TOP) / (max(tops) or 1.0)
    step = (WIDTH - LEFT) / len(BANDS)
    parts = [
        _write(0, TOP - 4, "RMS [N]", "start"),
        f'<line x1="{LEFT - 4:g}" y1="{FOOT:g}" x2="{WIDTH:g}" y2="{FOOT:g}" stroke="{INK}" stroke-width="0.8"/>',
    ]
    for number, (band, group) in enumerate(zip(BANDS, groups, strict=True)):
        middle = LEFT + (number + 0.5) * step
        for place, bar in enumerate(group):
            parts += _list_bar(bar, middle + PITCH * (place - (len(group) - 1) / 2), scale, named=len(group) > 1)
        parts += [_draw_waves(middle, PERIODS[number]), _write(middle, HEIGHT - 3, f"{band.low:g}–{band.high:g} Hz")]
    size = f'viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}pt" height="{HEIGHT:g}pt"'
    drawing = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(parts)}</svg>'
    return DrawnFigure(drawing, _list_data(groups))


def _list_data(groups: Sequence[Sequence[BandBar]]) -> Iterator[DrawnData]:
    """Values at the upper edges of the bands, half-widths of their intervals and limits; NaN for a missing one."""
    for owner in sorted({bar.owner for group in groups for bar in group}):
        bars = [
            (band.high, bar) for band, group in zip(BANDS, groups, strict=True) for bar in group if bar.owner == owner
        ]
        limits = [bar.limits or (math.nan, math.nan) for _, bar in bars]
        columns = {
            "value": [bar.value for _, bar in bars],
            "uncertainty": [math.nan if bar.uncertainty is None else bar.uncertainty for _, bar in bars],
            "lower limit": [low for low, _ in limits],
            "upper limit": [high for _, high in limits],
        }
        for name, values in columns.items():
            places = np.array([place for place, _ in bars])
            yield DrawnData(
                name_panel("frequency [Hz]", "RMS [N]"), f"pantograph {owner}, {name}", places, np.array(values)
            )


def _list_bar(bar: BandBar, x: float, scale: float, *, named: bool) -> Iterator[str]:
    """Limits, bar, whisker and value of a bar with its middle at x."""

    def at(value: float) -> float:
        return FOOT - scale * max(value, 0.0)

    left, fill = x - BAR / 2, SHADES[(bar.owner - 1) % 3]
    if bar.limits is not None:
        low, high = bar.limits
        height = f'height="{at(low) - at(high):.2f}" y="{at(high):.2f}"'
        yield f'<rect {height} x="{left - 7:.2f}" width="{BAR + 14:g}" fill="{LIMIT_FILL}"/>'
    look = f'fill="{fill}"' if bar.supported else f'fill="white" stroke="{GREY}" stroke-dasharray="3 2"'
    top = at(bar.value)
    yield f'<rect x="{left:.2f}" y="{top:.2f}" width="{BAR:g}" height="{FOOT - top:.2f}" {look}/>'
    if bar.limits is not None:
        edges = "".join(f"M{left - 7:.2f} {at(limit):.2f}h{BAR + 14:g}" for limit in bar.limits)
        yield f'<path d="{edges}" stroke="{GREY}" stroke-width="0.9" stroke-dasharray="4 2"/>'
    ends = [at(bar.value + sign * (bar.uncertainty or 0.0)) for sign in (1, -1)]
    if bar.uncertainty:
        whisker = f"M{x:.2f} {ends[0]:.2f}V{ends[1]:.2f}M{x - 4:.2f} {ends[0]:.2f}h8M{x - 4:.2f} {ends[1]:.2f}h8"
        yield f'<path d="{whisker}" stroke="white" stroke-width="2.6"/>'
        yield f'<path d="{whisker}" stroke="{INK}" stroke-width="1"/>'
    highest = min(ends[0], at(bar.limits[1]) if bar.limits else ends[0])
    yield _write(x, highest - 4, format_value(bar.value, 3))
    if named:
        yield _write(x, FOOT - 4, f"{bar.owner}", colour="white" if bar.supported else INK)


def _draw_waves(middle: float, periods: int) -> str:
    """Sine of some periods below a group: slow, medium or fast."""
    count, length = 16 * periods, 60.0
    points = " ".join(
        f"{middle + length * (i / count - 0.5):.2f},{FOOT + 12 - 5 * math.sin(2 * math.pi * i / 16):.2f}"
        for i in range(count + 1)
    )
    return f'<polyline points="{points}" fill="none" stroke="{SHADES[1]}" stroke-width="0.9"/>'


def _write(x: float, y: float, text: str, anchor: str = "middle", colour: str = INK) -> str:
    return (
        f'<text x="{x:.2f}" y="{y:.2f}" font-family="DejaVu Sans" font-size="8" text-anchor="{anchor}" '
        f'fill="{colour}">{text}</text>'
    )
