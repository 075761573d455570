"""Curves, charts and tables of results.json: everything that a page draws."""

from typing import Annotated, Literal, Self, TypeVar

from pydantic import Field, model_validator

from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart

Part = TypeVar("Part", bound=ResultsPart)


def check_lengths(part: Part, *lists: list[float]) -> Part:
    """Return a part whose lists have one length."""
    lengths = dict.fromkeys(map(len, lists))
    if len(lengths) > 1:
        raise ValueError(f"lists of {' and '.join(map(str, lengths))} numbers, expected one length")
    return part


class Spectrum(ResultsPart):
    """Single-sided amplitude spectrum of the delivered force about its mean, over the analysis section."""

    frequency_Hz: list[float]
    amplitude_N: list[float]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.frequency_Hz, self.amplitude_N)


class Histogram(ResultsPart):
    """Share of the samples of the 20 Hz force in each class."""

    edges_N: list[float]
    share_pct: list[float]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.edges_N[1:], self.share_pct)


class Traces(ResultsPart):
    """Curves of one pantograph over the analysis section."""

    position_m: list[float]
    force_N: list[float]
    force_20_N: list[float] | None
    strip_forces_N: Annotated[list[list[float]] | None, Field(exclude_if=lambda value: value is None)] = None
    """Contact forces of front and rear strip; left out if they are not recorded."""
    mean_N: float
    std_N: float | None
    supports_m: list[float]
    spectrum: Spectrum
    histogram: Histogram | None

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(
            self,
            self.position_m,
            self.force_N,
            self.force_N if self.force_20_N is None else self.force_20_N,
            *(self.strip_forces_N or ()),
        )


class ExtremePlace(ResultsPart):
    """Place of an extreme: contact point for a force, support for an uplift."""

    position_m: FiniteNumber
    time_s: FiniteNumber | None = None
    """Time of the largest uplift; null for a force."""


class UpliftTrace(ResultsPart):
    """Uplift of the contact wire at one support."""

    support_m: float
    time_s: list[float]
    uplift_mm: list[float]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.time_s, self.uplift_mm)


class Series(ResultsPart):
    """Data of a chart.

    `crosses` lie over points of other series; `boxes` draws a box plot of the values at each x; `bars` stand side by
    side at the ticks; `tornado` draws horizontal bars, one below the other, at the ticks; `band` is the area between
    `y` and `high`.
    """

    label: str
    style: Literal["line", "points", "crosses", "boxes", "bars", "band", "tornado"]
    x: list[float]
    y: list[float]
    high: list[float] | None = None
    """Upper edge of a band."""
    error: list[float] | None = None
    """Half the length of the error bar of each point, or half the width of the band along a line."""

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, *(part for part in (self.x, self.y, self.high, self.error) if part is not None))


class Mark(ResultsPart):
    """A published value or a limit: a line across a chart, or a band if `high` is given."""

    label: str
    axis: Literal["x", "y"]
    low: float
    high: float | None = None


class Chart(ResultsPart):
    """Figure of a study."""

    caption: str
    alternative: str
    x_label: str
    y_label: str
    x_scale: Literal["linear", "log"] = "linear"
    y_scale: Literal["linear", "log"] = "linear"
    ticks: list[str] | None = None
    """Names at x = 0, 1, 2, ..."""
    series: list[Series]
    marks: list[Mark] = []
    wide: bool = True


class DrawnCurve(ResultsPart):
    """Wire in a view of a line at rest, thinned: heights or lateral positions along the line."""

    kind: Literal["contact_wire", "messenger_wire", "stitch_wire"]
    x_m: list[FiniteNumber]
    y_m: list[FiniteNumber]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.x_m, self.y_m)


class DrawnDroppers(ResultsPart):
    """Droppers in a view of a line at rest: positions, and heights or lateral positions of both ends."""

    x_m: list[FiniteNumber]
    lower_m: list[FiniteNumber]
    upper_m: list[FiniteNumber]

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return check_lengths(self, self.x_m, self.lower_m, self.upper_m)


class DrawnSymbol(ResultsPart):
    """Symbol of the points of one kind."""

    name: Annotated[str, Field(pattern="^[a-z][a-z -]{1,39}$")]
    marker: Literal["^", "v", "<", ">", "o", "s", "D", "d", "p", "h", "P", "X", "*"]
    """Marker of matplotlib."""
    filled: bool = True


class DrawnPoint(ResultsPart):
    """Part that is drawn as a point, with a text beside it."""

    symbol: str
    """Name of its symbol."""
    x_m: FiniteNumber
    y_m: FiniteNumber
    text: str = ""


class DrawnView(ResultsPart):
    """Side view or plan view of a line at rest."""

    curves: list[DrawnCurve]
    droppers: DrawnDroppers
    points: list[DrawnPoint]


class LineShape(ResultsPart):
    """Line at rest over some spans, for a drawing: `plan` is null for a line in the vertical plane."""

    title: str
    first_span: int
    last_span: int
    supports_m: Annotated[list[FiniteNumber], Field(min_length=2)]
    side: DrawnView
    plan: DrawnView | None
    symbols: list[DrawnSymbol]
    """Symbols of the points of both views."""

    @model_validator(mode="after")
    def _known_symbols(self) -> Self:
        points = [point for view in (self.side, self.plan) if view is not None for point in view.points]
        if unknown := {point.symbol for point in points} - {symbol.name for symbol in self.symbols}:
            raise ValueError(f"points without a symbol: {', '.join(sorted(unknown))}")
        return self


class TextTable(ResultsPart):
    """Table of a study as text."""

    caption: str
    columns: list[str]
    rows: list[list[str]]
