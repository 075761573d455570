"""Format of identification.json: results of an identification, line by line."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.core.json_file import Rounded, RoundedModel
from pantocheck.conformance.core.units import MotionQuantity
from pantocheck.conformance.results.identified_modes import Mode

Curve = list[float]
"""Values of a curve on one axis, with six significant digits."""


class RecordSensor(RoundedModel):
    """Sensor of a vertical channel."""

    channel: str
    """Name of the channel."""
    wire: str
    """Wire with the sensor: CW (contact wire) or MW (messenger wire); empty: unknown."""
    position_m: float | None
    """Distance from the first support [m]; null: unknown."""
    onset_s: Rounded | None = None
    """First motion of the sensor, in the time of the record [s]; null: not found."""


class IdentifiedRecord(RoundedModel):
    """Mass-drop record, and the part of it in the identification."""

    name: str
    source: str
    """Name of the file."""
    sampling_rate_Hz: float
    length_s: Rounded
    mass_kg: float | None
    drop_wire: str
    drop_position_m: float | None
    release_s: Rounded
    """Release, in the time of the record [s]."""
    used_from_s: Rounded
    """Start of the linear decay, in the time of the record [s]."""
    used_to_s: Rounded
    """End of the linear decay, in the time of the record [s]."""
    channels: tuple[str, ...]
    """Names of the vertical channels."""
    sensors: tuple[RecordSensor, ...] = ()
    """Sensors of these channels."""
    residual_time_s: Curve = []
    """Middle of the windows of the residual that chose the linear decay, after the release [s]; empty: no window."""
    residual_over_rest: Curve = []
    """RMS of this residual over that of the motion at rest, median of the channels [-]."""


class ModeGroup(RoundedModel):
    """Group of span modes: one mode per span, around a multiple of the frequency of the first group."""

    group: int
    """Number of the group, from 1."""
    modes: int
    """Number of modes."""
    certain: int
    """Number of modes whose damping ratio is certain."""
    from_Hz: Rounded
    to_Hz: Rounded
    median_damping_ratio: Rounded | None
    """Median of the certain modes [-]."""
    lowest: Rounded | None
    """Lowest damping ratio of the certain modes [-]."""
    highest: Rounded | None
    """Highest damping ratio of the certain modes [-]."""
    ambient_rms: Rounded | None = None
    """RMS of the ambient motion in the frequencies of the group, over sensors and records; null: none found."""
    noise_rms: Rounded | None = None
    """RMS of the noise of the sensors in the same frequencies; null as above."""


class Comparison(RoundedModel):
    """Comparison of two records of one drop at one channel, in a window at the start and another a minute later.

    Keys that end in `later` are null if the records are too short.
    """

    first: str
    second: str
    channel: str
    shift_s: Rounded
    """Delay of the second record [s]."""
    correlation_at_start: Rounded
    correlation_later: Rounded | None
    possible_at_start: Rounded
    """Correlation of equal signals with the same noise [-]."""
    possible_later: Rounded | None
    residual_at_start: Rounded
    """RMS of the difference over RMS of the first record [-]."""
    residual_later: Rounded | None


class Repeatability(RoundedModel):
    """Comparisons of the repeats of a drop with its first record, and their verdict."""

    verdict: Literal["repeatable", "not repeatable"]
    reason: str
    comparisons: tuple[Comparison, ...]


class CurveWindow(RoundedModel):
    """Motion at one channel in a time window after the release, low-pass filtered."""

    time_s: Curve
    signal: Curve
    """Measured quantity [SI unit]."""
    velocity_m_s: Curve
    acceleration_m_s2: Curve


class OverlayRun(RoundedModel):
    """Signals of one record in time windows."""

    name: str
    windows: tuple[CurveWindow, ...]


class Overlay(RoundedModel):
    """Signals of the records of a drop at the channel with the largest motion."""

    channel: str
    runs: tuple[OverlayRun, ...]


class SpectrogramPart(RoundedModel):
    """Levels of the amplitude of one channel over time and frequency."""

    window_s: float
    """Length of a window [s]."""
    time_s: Curve
    """Middle of each window after the release [s]."""
    frequency_Hz: Curve
    level_dB: tuple[tuple[int, ...], ...]
    """Levels at each time, one per frequency [dB]; 0 dB: largest amplitude; lowest: -60 dB."""


class Spectrogram(RoundedModel):
    """Spectrogram of the channel of a record with the largest motion."""

    record: str
    channel: str
    whole: SpectrogramPart
    """Whole record."""
    start: SpectrogramPart
    """Around the release."""


class BandOrders(RoundedModel):
    """Poles of all orders in one band of the search for start poles; three lists with one entry per pole."""

    from_Hz: Rounded
    to_Hz: Rounded
    selected_order: int
    """Order with the lowest Bayesian information criterion; 0: none."""
    order: tuple[int, ...]
    """Number of poles in the band and its flanks."""
    frequency_Hz: Curve
    stable: tuple[bool, ...]
    """true: frequency and damping ratio differ little from the order before."""


class SearchStep(RoundedModel):
    """Frequencies of the poles after one step of the search."""

    name: str
    frequency_Hz: Curve


class OrderSearch(RoundedModel):
    """Search for the model order: trials of start poles, and steps that add and remove poles."""

    bands: tuple[BandOrders, ...]
    """Bands of the trials; empty: start poles were given."""
    steps: tuple[SearchStep, ...]


class RecordSpectra(RoundedModel):
    """Transforms of the channels of a record, measured and fitted [unit of the record times s]."""

    record: str
    channels: tuple[str, ...]
    frequency_Hz: Curve
    measured: tuple[Curve, ...]
    fitted: tuple[Curve, ...]
    residual: tuple[Curve, ...]
    poles_Hz: tuple[Rounded, ...]
    """Frequencies of the identified modes [Hz]."""


class ResponseCurve(RoundedModel):
    """Accelerance of one channel."""

    model_config = ConfigDict(populate_by_name=True)

    magnitude: Annotated[Curve, Field(alias="abs")]
    """Magnitude [m/s2/N]."""
    phase_rad: Curve


class RecordResponses(RoundedModel):
    """Frequency responses of the channels of a record to the release, measured and identified."""

    record: str
    channels: tuple[str, ...]
    frequency_Hz: Curve
    measured: tuple[ResponseCurve, ...]
    identified: tuple[ResponseCurve, ...]


class HalfPowerLines(RoundedModel):
    """Modes with few spectral lines in their half-power band."""

    recommended: int
    """Recommended number of spectral lines in the half-power band."""
    modes: int
    """Number of modes."""
    fewer: int
    """Number of modes with fewer spectral lines."""
    needed_s: Rounded | None
    """Linear decay that gives the recommended number to every certain mode [s]."""


class IdentifiedClock(RoundedModel):
    """Clock of a sensor against that of the first one."""

    sensor: int
    rate_ppm: Rounded
    """Relative rate; positive: the clock is fast."""
    rate_std_ppm: Rounded
    start_ms: Rounded
    """Start of its record after that of the first sensor [ms]."""
    corrected: bool
    """Whether the record was corrected; otherwise the sensors share a clock within the uncertainty."""


class IdentifiedLine(RoundedModel):
    """Identification of one line from all its records."""

    quantity: MotionQuantity
    """Measured quantity."""
    band_Hz: tuple[float, float]
    """Band of the reported modes [Hz]."""
    misfit: Rounded
    """Squared residual over its expectation for noise [-]; 1: complete model."""
    warnings: tuple[str, ...]
    spans_m: tuple[float, ...] = ()
    """Lengths of the spans [m]; empty: unknown."""
    records: tuple[IdentifiedRecord, ...]
    clocks: tuple[IdentifiedClock, ...] = ()
    """Clocks of the sensors; empty: a single sensor, or not compared."""
    shared_clock: bool | None = None
    """Clock that the records state; null: not stated."""
    groups: tuple[ModeGroup, ...]
    modes: tuple[Mode, ...]
    half_power: HalfPowerLines
    """Spectral lines in the half-power band."""
    repeatability: tuple[Repeatability, ...]
    """Repeatability of each repeated drop."""
    overlays: tuple[Overlay, ...]
    """Signals of each repeated drop; of the first drop if none is repeated."""
    spectrogram: Spectrogram
    """Spectrogram of the first record."""
    order_search: OrderSearch
    """Search for the number of poles."""
    spectra: tuple[RecordSpectra, ...]
    """Spectra of each record."""
    frequency_responses: tuple[RecordResponses, ...]
    """Frequency responses of each record with a known mass."""


class IdentificationFile(RoundedModel):
    """Content of identification.json."""

    schema_: Annotated[Literal["pantocheck.identification/1"], Field(alias="schema")] = "pantocheck.identification/1"
    lines: tuple[IdentifiedLine, ...]
