"""Quantities of a record: statistics of the contact force, the contact height and the uplift at the supports.

To add a statistic, add its definition here; value, uncertainty, label and tables follow from it.
"""

from collections.abc import Callable

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import BANDS, Band
from pantocheck.conformance.quantities.quantity import LineQuantity, PantographQuantity
from pantocheck.conformance.quantities.sampling import Sampling
from pantocheck.conformance.quantities.signals import ForceSignals
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, contact_loss, statistical_extremes

FORCE, UNFILTERED_TO_50_HZ = "contact force", "contact force not filtered below 50 Hz"
EN50318, VOVAN2015 = "EN 50318", "Vo Van et al. 2015, Table 1"


def _mean(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.mean(signals.delivered)


def _std_20(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.std(signals.graded)


def _std_50(signals: ForceSignals, sampling: Sampling) -> RealArray:
    return sampling.std(signals.extended)


def _statistical_extreme(side: int) -> Callable[[ForceSignals, Sampling], RealArray]:
    return lambda signals, sampling: statistical_extremes(_mean(signals, sampling), _std_20(signals, sampling))[side]


def _band_quantity(band: Band) -> PantographQuantity:
    low, high, name = band
    return PantographQuantity(
        name=name,
        label=f"RMS, {low:g}–{high:g} Hz",
        unit="N",
        definition=f"RMS of the contact force in the band ]{low:g}, {high:g}] Hz",
        needs=FORCE if high <= 20 else UNFILTERED_TO_50_HZ,
        source=VOVAN2015,
        never_negative=True,
        tables=("bands", "damping models"),
        compute=lambda signals, sampling: sampling.band_rms(signals, band),
    )


PANTOGRAPH_QUANTITIES: tuple[PantographQuantity, ...] = (
    PantographQuantity(
        name="mean_force_N",
        label="Mean contact force",
        unit="N",
        definition="mean contact force over the analysis section",
        needs=FORCE,
        source=EN50318,
        tables=("damping models",),
        compute=_mean,
    ),
    PantographQuantity(
        name="std_force_N",
        label="Standard deviation, 0–20 Hz",
        unit="N",
        definition="standard deviation of the contact force, 0-20 Hz",
        needs=FORCE,
        source=EN50318,
        never_negative=True,
        tables=("bands", "damping models"),
        compute=_std_20,
    ),
    PantographQuantity(
        name="std_force_50_N",
        label="Standard deviation, 0–50 Hz",
        unit="N",
        definition="standard deviation of the contact force, 0-50 Hz",
        needs=UNFILTERED_TO_50_HZ,
        source=VOVAN2015,
        never_negative=True,
        tables=("bands", "damping models"),
        compute=_std_50,
    ),
    PantographQuantity(
        name="cov_20",
        label="Coefficient of variation, 0–20 Hz",
        unit="",
        definition="coefficient of variation: std_force_N over mean_force_N",
        needs=FORCE,
        source=VOVAN2015,
        tables=("bands", "damping models"),
        compute=lambda signals, sampling: coefficient_of_variation(
            _mean(signals, sampling), _std_20(signals, sampling)
        ),
    ),
    PantographQuantity(
        name="cov_50",
        label="Coefficient of variation, 0–50 Hz",
        unit="",
        definition="coefficient of variation: std_force_50_N over mean_force_N",
        needs=UNFILTERED_TO_50_HZ,
        source=VOVAN2015,
        tables=("bands", "damping models"),
        compute=lambda signals, sampling: coefficient_of_variation(
            _mean(signals, sampling), _std_50(signals, sampling)
        ),
    ),
    *map(_band_quantity, BANDS),
    PantographQuantity(
        name="statistical_max_N",
        label="Statistical maximum, mean + 3 σ",
        unit="N",
        definition="mean_force_N plus three times std_force_N",
        needs=FORCE,
        source=EN50318,
        compute=_statistical_extreme(1),
    ),
    PantographQuantity(
        name="statistical_min_N",
        label="Statistical minimum, mean − 3 σ",
        unit="N",
        definition="mean_force_N minus three times std_force_N",
        needs=FORCE,
        source=EN50318,
        compute=_statistical_extreme(0),
    ),
    PantographQuantity(
        name="max_force_N",
        label="Maximum of the 20 Hz force",
        unit="N",
        definition="largest contact force, 0-20 Hz",
        needs=FORCE,
        source=EN50318,
        tables=("damping models",),
        compute=lambda signals, sampling: sampling.largest(signals.graded),
    ),
    PantographQuantity(
        name="min_force_N",
        label="Minimum of the 20 Hz force",
        unit="N",
        definition="smallest contact force, 0-20 Hz",
        needs=FORCE,
        source=EN50318,
        tables=("damping models",),
        compute=lambda signals, sampling: sampling.smallest(signals.graded),
    ),
    PantographQuantity(
        name="contact_loss_pct",
        label="Contact loss",
        unit="%",
        definition="share of the samples of the unfiltered force without contact",
        needs="unfiltered contact force",
        source=EN50318,
        never_negative=True,
        tables=("damping models",),
        compute=lambda signals, sampling: contact_loss(signals.delivered, signals.filter_applied_Hz, sampling),
    ),
    PantographQuantity(
        name="contact_height_range_mm",
        label="Range of the contact point's height",
        unit="mm",
        definition="highest minus lowest contact point over the analysis section",
        needs="contact height",
        source=EN50318,
        never_negative=True,
        compute=lambda signals, sampling: sampling.extent(signals.height, 1e3),
    ),
)

LINE_QUANTITIES: tuple[LineQuantity, ...] = (
    LineQuantity(
        name="max_uplift_at_support_mm",
        label="Maximum uplift at a support",
        unit="mm",
        definition="largest unfiltered uplift of the contact wire at any support of the analysis section, "
        "over the whole record",
        needs="uplift at supports",
        source=EN50318,
        tables=("damping models",),
        compute=lambda signals: float(1e3 * signals.uplift.max()),
    ),
)
