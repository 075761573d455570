"""Quantities of a record: statistics of the contact force, the contact height and the uplift at the supports.

Each definition here gives the value, the uncertainty, the label and the tables of its quantity.
"""

from functools import partial

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import BANDS, Band
from pantocheck.conformance.quantities.contact_losses import loss_durations, loss_starts
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals
from pantocheck.conformance.quantities.quantity import LineQuantity, Need, PantographQuantity
from pantocheck.conformance.quantities.statistics import (
    Sampling,
    check_unfiltered,
    coefficient_of_variation,
    contact_loss,
    statistical_extremes,
)

EN50318, VOVAN2015 = "EN 50318", "Vo Van et al. 2015, Table 1"

FORCE = Need[ForceSignals]("contact force over the whole analysis section", lambda signals: signals.delivered)
FORCE_20 = Need[ForceSignals](
    "contact force over the whole analysis section, at a rate for 20 Hz", lambda signals: signals.graded
)
FORCE_50 = Need[ForceSignals](
    "contact force over the whole analysis section, not filtered below 50 Hz, at a rate for 50 Hz",
    lambda signals: signals.extended,
)
HEIGHT = Need[ForceSignals]("contact height over the whole analysis section", lambda signals: signals.height)
ALL_SUPPORTS = Need[LineSignals](
    "uplift at every support of the analysis section", lambda signals: signals.check_supports()
)

_en50318 = partial(PantographQuantity, source=EN50318, needs=FORCE_20, unit="N", highest_Hz=20.0)
_vovan2015 = partial(PantographQuantity, source=VOVAN2015, tables=("damping models",))
_vovan2015_20 = partial(_vovan2015, needs=FORCE, highest_Hz=20.0)
_vovan2015_50 = partial(_vovan2015, needs=FORCE_50, highest_Hz=50.0)


_loss = partial(PantographQuantity, needs=FORCE_50, never_negative=True, highest_Hz=50.0)


def _unfiltered(signals: ForceSignals) -> RealArray:
    """Force in which contact losses are visible [N]; raises `AlreadyFiltered`."""
    check_unfiltered(signals.filter_applied_Hz)
    return signals.delivered


def _mean(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.mean(signals.delivered)


def _std_20(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.std(signals.graded)


def _std_50(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.std(signals.extended)


def _extremes(signals: ForceSignals, sampling: Sampling) -> tuple[RealArray, RealArray]:
    return statistical_extremes(_mean(signals, sampling), _std_20(signals, sampling))


BAND_PASS_CHANGE = {"rms_0_5_N": 1.2, "rms_5_20_N": 1.5, "rms_20_50_N": 6.8}
"""Largest change of a band by a band-pass on the EN 50318:2002 cases [%] (verification/tables/filter_and_band.py)."""


def _causal(change: float) -> str:
    """Change by a causal filter on these cases [%], from the same program."""
    return f"a causal filter of the same order changes it by up to {change:g} %"


def _band_quantity(band: Band) -> PantographQuantity:
    low, high, name = band
    define = _vovan2015_20 if high <= 20 else _vovan2015_50
    return define(
        name=name,
        highest_Hz=float(high),
        label=f"RMS, {low:g}–{high:g} Hz",
        unit="N",
        definition=f"RMS of the contact force in the band ]{low:g}, {high:g}] Hz, by Parseval on the analysis section "
        "unless the filter states band-passes",
        never_negative=True,
        other_definition=f"a zero-phase band-pass changes it by up to {BAND_PASS_CHANGE[name]:g} % on two spans",
        compute=lambda signals, sampling: sampling.band_rms(signals, band),
    )


PANTOGRAPH_QUANTITIES: tuple[PantographQuantity, ...] = (
    _en50318(
        name="mean_force_N",
        label="Mean contact force",
        definition="mean contact force over the analysis section",
        needs=FORCE,
        highest_Hz=None,
        tables=("damping models",),
        compute=_mean,
    ),
    _en50318(
        name="std_force_N",
        label="Standard deviation, 0–20 Hz",
        definition="standard deviation of the contact force, 0-20 Hz",
        other_definition=_causal(1.6),
        never_negative=True,
        tables=("damping models",),
        compute=_std_20,
    ),
    _vovan2015_50(
        name="std_force_50_N",
        label="Standard deviation, 0–50 Hz",
        unit="N",
        definition="standard deviation of the contact force, 0-50 Hz",
        never_negative=True,
        compute=_std_50,
    ),
    _vovan2015_20(
        name="cov_20",
        label="Coefficient of variation, 0–20 Hz",
        unit="",
        definition="coefficient of variation: std_force_N over mean_force_N",
        compute=lambda *arguments: coefficient_of_variation(_mean(*arguments), _std_20(*arguments)),
    ),
    _vovan2015_50(
        name="cov_50",
        label="Coefficient of variation, 0–50 Hz",
        unit="",
        definition="coefficient of variation: std_force_50_N over mean_force_N",
        compute=lambda *arguments: coefficient_of_variation(_mean(*arguments), _std_50(*arguments)),
    ),
    *map(_band_quantity, BANDS),
    _en50318(
        name="statistical_max_N",
        label="Statistical maximum, mean + 3 σ",
        definition="mean_force_N plus three times std_force_N",
        compute=lambda *arguments: _extremes(*arguments)[1],
    ),
    _en50318(
        name="statistical_min_N",
        label="Statistical minimum, mean − 3 σ",
        definition="mean_force_N minus three times std_force_N",
        compute=lambda *arguments: _extremes(*arguments)[0],
    ),
    _en50318(
        name="max_force_N",
        label="Maximum of the 20 Hz force",
        definition="largest contact force, 0-20 Hz",
        other_definition=_causal(1.4),
        tables=("damping models",),
        extreme="largest",
        compute=lambda signals, sampling: sampling.largest(signals.graded),
    ),
    _en50318(
        name="min_force_N",
        label="Minimum of the 20 Hz force",
        definition="smallest contact force, 0-20 Hz",
        other_definition=_causal(15),
        tables=("damping models",),
        extreme="smallest",
        compute=lambda signals, sampling: sampling.smallest(signals.graded),
    ),
    _en50318(
        name="contact_loss_pct",
        label="Contact loss",
        unit="%",
        definition="share of the samples of the unfiltered force without contact",
        needs=FORCE_50,
        highest_Hz=50.0,
        never_negative=True,
        tables=("damping models",),
        compute=lambda signals, sampling: contact_loss(signals.delivered, signals.filter_applied_Hz, sampling),
    ),
    _loss(
        name="longest_contact_loss_s",
        label="Longest contact loss",
        unit="s",
        definition="duration of the longest contact loss in the unfiltered force",
        extreme="largest",
        compute=lambda signals, sampling: sampling.largest(loss_durations(_unfiltered(signals), signals.rate)),
    ),
    _loss(
        name="contact_loss_events",
        label="Number of contact losses",
        unit="",
        definition="number of contact losses in the unfiltered force",
        compute=lambda signals, sampling: signals.delivered.size * sampling.mean(loss_starts(_unfiltered(signals))),
    ),
    _en50318(
        name="contact_height_range_mm",
        label="Range of the contact point's height",
        unit="mm",
        definition="highest minus lowest contact point over the analysis section",
        needs=HEIGHT,
        highest_Hz=None,
        never_negative=True,
        extreme="largest",
        compute=lambda signals, sampling: sampling.extent(signals.height, 1e3),
    ),
)

LINE_QUANTITIES: tuple[LineQuantity, ...] = (
    LineQuantity(
        name="max_uplift_at_support_mm",
        label="Maximum uplift at a support",
        unit="mm",
        definition="largest unfiltered uplift of the contact wire at any support of the analysis section, until the "
        "last pantograph is 60 m past that support",
        needs=ALL_SUPPORTS,
        source=EN50318,
        tables=("damping models",),
        compute=lambda signals: 1e3 * signals.largest_uplift,
        support_values=lambda signals: 1e3 * signals.largest_uplifts,
    ),
)
