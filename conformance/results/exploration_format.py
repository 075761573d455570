"""Page of `pantocheck explore`: its sliders, and passages at settings of them. There is no verdict in it."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.figure_data import LineShape, Traces, UpliftTrace
from pantocheck.conformance.core.results_part import FiniteNumber, Owner, ResultsPart
from pantocheck.conformance.results.motion_format import PassageMotion


class Slider(ResultsPart):
    """Input that the reader changes."""

    id: str
    """Name in requests."""
    label: str
    unit: str
    value: FiniteNumber
    """Value of the case; of a factor 1."""
    low: FiniteNumber
    high: FiniteNumber
    step: Annotated[FiniteNumber, Field(gt=0)]
    """Step of the slider; a number that is typed may lie between two steps."""
    keys: dict[str, FiniteNumber]
    """Values of the case by their keys of `--set`. A factor multiplies them, another input is their new value."""
    is_factor: bool = False
    is_logarithmic: bool = False
    """Whether equal steps of the slider multiply the value by equal factors."""


class ExploredValue(ResultsPart):
    """Value of a passage beside the limits that the case has for its own inputs."""

    quantity: str
    label: str
    """Name of the quantity in words."""
    unit: str
    pantograph: int
    """Number of the pantograph, 0: the line."""
    value: FiniteNumber | None
    lower: FiniteNumber | None = None
    upper: FiniteNumber | None = None
    is_inside: bool | None = None
    """Whether the value lies between the limits; null: there is no limit, or no value."""
    baseline: None = None
    """Always null: no value is compared with a baseline."""


class ExploredStretch(ResultsPart):
    """Run behind the values."""

    speed_km_h: FiniteNumber
    evaluated_m: tuple[FiniteNumber, FiniteNumber]
    """Analysis section."""
    rate_Hz: FiniteNumber
    """Samples per second."""


class ExploredPassage(ResultsPart):
    """Passage at one setting."""

    id: str
    """Id of the case."""
    number: int
    """Number of the request, with which its moving picture is asked for."""
    changes: list[str]
    """Changed inputs, as arguments of `--set`."""
    command: str
    """Command that simulates and grades the same inputs."""
    computing_s: FiniteNumber
    """Computing time of the passage, with the tuning of its uplift forces [s]."""
    run: ExploredStretch
    criteria: list[ExploredValue]
    """Values, in the order of their table."""
    traces: dict[Owner, Traces]
    uplift: list[UpliftTrace]
    line_shape: LineShape
    motion: PassageMotion | None = None
    """Moving picture, which follows in an answer of its own."""


class Exploration(ResultsPart):
    """Page before its first passage."""

    id: str
    """Id of the case."""
    title: str
    sliders: list[Slider]
    can_save: bool
    """Whether a folder for saved settings is named."""
    waiting: str
    """Sentence while the first passage is simulated; empty: it takes no longer than others."""
    cases: list[ExploredPassage] = Field(default_factory=list)
    """Passages on the page: setting 1, and 2 where it is kept."""
