"""Every quantity by name: unit, definition, and what it needs. A criterion is one of these names with limits."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.quantities.paper_quantities import STUDY_QUANTITIES
from pantocheck.conformance.quantities.quantity import Quantity
from pantocheck.conformance.quantities.signals import ForceSignals, LineSignals
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, contact_loss, statistical_extremes


@dataclass(frozen=True)
class PantographQuantity(Quantity):
    """A quantity computed from the signals of one pantograph."""

    compute: Callable[[ForceSignals], float]


@dataclass(frozen=True)
class LineQuantity(Quantity):
    """A quantity computed from the uplift at the supports."""

    compute: Callable[[LineSignals], float]


def _of_pantograph(
    name: str, unit: str, definition: str, needs: str, compute: Callable[[ForceSignals], float]
) -> PantographQuantity:
    return PantographQuantity(name, unit, definition, needs, "pantograph", compute)


def _band(low: float, high: float) -> Callable[[ForceSignals], float]:
    return lambda signals: signals.band(low, high)


def _mean(signals: ForceSignals) -> float:
    return float(signals.delivered.mean())


def _std(signals: ForceSignals) -> float:
    return float(signals.graded.std())


def _std_50(signals: ForceSignals) -> float:
    return float(signals.extended.std())


_FORCE, _RAW = "contact force", "contact force not filtered below 50 Hz"

PANTOGRAPH_QUANTITIES: tuple[PantographQuantity, ...] = (
    _of_pantograph("mean_force_N", "N", "mean contact force over the evaluated stretch", _FORCE, _mean),
    _of_pantograph("std_force_N", "N", "standard deviation of the contact force, 0-20 Hz", _FORCE, _std),
    _of_pantograph("std_force_50_N", "N", "standard deviation of the contact force, 0-50 Hz", _RAW, _std_50),
    _of_pantograph(
        "cov_20",
        "",
        "coefficient of variation: std_force_N over mean_force_N",
        _FORCE,
        lambda signals: coefficient_of_variation(_mean(signals), _std(signals)),
    ),
    _of_pantograph(
        "cov_50",
        "",
        "coefficient of variation: std_force_50_N over mean_force_N",
        _RAW,
        lambda signals: coefficient_of_variation(_mean(signals), _std_50(signals)),
    ),
    _of_pantograph("rms_0_5_N", "N", "rms of the contact force in the band ]0, 5] Hz", _FORCE, _band(0, 5)),
    _of_pantograph("rms_5_20_N", "N", "rms of the contact force in the band ]5, 20] Hz", _FORCE, _band(5, 20)),
    _of_pantograph("rms_20_50_N", "N", "rms of the contact force in the band ]20, 50] Hz", _RAW, _band(20, 50)),
    _of_pantograph(
        "statistical_max_N",
        "N",
        "mean_force_N plus three times std_force_N",
        _FORCE,
        lambda signals: statistical_extremes(_mean(signals), _std(signals))[1],
    ),
    _of_pantograph(
        "statistical_min_N",
        "N",
        "mean_force_N minus three times std_force_N",
        _FORCE,
        lambda signals: statistical_extremes(_mean(signals), _std(signals))[0],
    ),
    _of_pantograph(
        "max_force_N", "N", "largest contact force, 0-20 Hz", _FORCE, lambda signals: float(signals.graded.max())
    ),
    _of_pantograph(
        "min_force_N", "N", "smallest contact force, 0-20 Hz", _FORCE, lambda signals: float(signals.graded.min())
    ),
    _of_pantograph(
        "contact_loss_pct",
        "%",
        "share of the samples of the unfiltered force without contact",
        "contact force not filtered at all",
        lambda signals: contact_loss(signals.delivered, signals.filter_applied_Hz),
    ),
    _of_pantograph(
        "contact_height_range_mm",
        "mm",
        "highest minus lowest contact point over the evaluated stretch",
        "contact height",
        lambda signals: float(1e3 * np.ptp(signals.height)),
    ),
)

LINE_QUANTITIES: tuple[LineQuantity, ...] = (
    LineQuantity(
        "max_uplift_at_support_mm",
        "mm",
        "largest unfiltered uplift of the contact wire at any support of the evaluated spans, over the whole record",
        "uplift at supports",
        "line",
        lambda signals: float(1e3 * signals.uplift.max()),
    ),
)

GIVEN_QUANTITIES: tuple[Quantity, ...] = (
    Quantity("presag_mm", "mm", "sag of the contact wire at the droppers, one value each", "initial state", "static"),
    Quantity(
        "dropper_length_m",
        "m",
        "length of the droppers of a span by string statics in the vertical plane, one value each",
        "initial state",
        "static",
    ),
    Quantity(
        "dropper_length_bending_m",
        "m",
        "the same with the bending stiffness of the wires",
        "initial state",
        "static",
    ),
    Quantity(
        "dropper_length_stagger_m",
        "m",
        "the same with bending stiffness and stagger: along the inclined droppers",
        "initial state of a line with stagger",
        "static",
    ),
    Quantity(
        "elasticity_mm_N",
        "mm/N",
        "largest uplift per force along a span, for a force that slackens no dropper",
        "static check",
        "static",
    ),
    Quantity(
        "elasticity_non_uniformity_pct",
        "%",
        "(largest - smallest) / (largest + smallest) elasticity along a span",
        "static check",
        "static",
    ),
    Quantity(
        "elasticity_along_span_mm_N",
        "mm/N",
        "uplift per force at equal distances from a support on, for a force that slackens no dropper",
        "static check",
        "static",
    ),
    Quantity(
        "elasticity_200_N_mm_N",
        "mm/N",
        "largest uplift per force along a span for 200 N, droppers slackening",
        "static check",
        "static",
    ),
    Quantity(
        "elasticity_200_N_non_uniformity_pct",
        "%",
        "the non-uniformity for 200 N, droppers slackening",
        "static check",
        "static",
    ),
    Quantity(
        "elasticity_200_N_along_span_mm_N",
        "mm/N",
        "uplift per force at equal distances from a support on, for 200 N, droppers slackening",
        "static check",
        "static",
    ),
    Quantity("wave_speed_m_s", "m/s", "speed of transverse waves on the contact wire", "static check", "static"),
    Quantity(
        "reflection_coefficient",
        "",
        "share of a wave on the contact wire that a dropper reflects: sqrt(T m) of the messenger over that of both",
        "static check",
        "static",
    ),
    Quantity("doppler_factor", "", "(c - v) / (c + v), c the wave speed, v the train's", "static check", "static"),
    Quantity(
        "amplification_coefficient",
        "",
        "reflection coefficient over Doppler factor",
        "static check",
        "static",
    ),
    Quantity(
        "natural_frequency_Hz",
        "Hz",
        "first natural frequencies of up to ten spans of the line, modes of mainly vertical motion",
        "static check",
        "static",
    ),
    Quantity(
        "apparent_mass_kg",
        "kg",
        "size of the apparent mass of each pantograph's head, force over acceleration, at the case's frequencies",
        "pantograph model",
        "static",
    ),
    Quantity(
        "speed_over_wave_speed",
        "",
        "speed of the train over the speed of transverse waves on the contact wire",
        "wave speed",
        "static",
    ),
    Quantity("mode_frequency_Hz", "Hz", "frequency of a mode, or of a group of modes", "mass-drop record", "mass_drop"),
    Quantity("damping_ratio", "", "damping ratio of a mode, or of a group of modes", "mass-drop record", "mass_drop"),
    *STUDY_QUANTITIES,
)
"""Quantities that a static check, an identification or a study delivers; nothing is computed from a single record."""

QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity for quantity in (*PANTOGRAPH_QUANTITIES, *LINE_QUANTITIES, *GIVEN_QUANTITIES)
}
"""All of them, in the order they are reported."""
