"""Registry of all quantities by name. A criterion is one of these names with limits."""

import re

from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.quantity import Need, Quantity, QuantityTable, Scope
from pantocheck.conformance.quantities.stated_quantities import OVERLAP_QUANTITIES, STATED_QUANTITIES

# Quantities of the line at rest, of identified modes and of studies after Vo Van, Balmes and Lorang (2015).
#
# A static check, an identification or a study delivers these quantities; none of them is computed from a record.
EDGES = re.compile(r"(?<=_)(?:5|20|50)(?=_|$)")
"""Edges of the bands in the names of quantities."""
_NEVER_NEGATIVE = {"elasticity_mm_N", "wave_speed_m_s"}


def _define(scope: Scope, needs: str, *rows: tuple[str, str, str, str]) -> list[Quantity]:
    """Define quantities with the same scope and needs, from rows of name, label, unit and definition."""
    return [
        Quantity(
            name=name,
            label=label,
            unit=unit,
            definition=definition,
            needs=Need(needs),
            scope=scope,
            never_negative=name in _NEVER_NEGATIVE,
            highest_Hz=max(map(float, EDGES.findall(name)), default=None),
        )
        for name, label, unit, definition in rows
    ]


# fmt: off
DELIVERED_QUANTITIES: tuple[Quantity, ...] = (
    *_define(
        "static", "initial state",
        ("presag_mm", "Pre-sag", "mm", "sag of the contact wire at each dropper"),
        ("dropper_length_m", "Dropper length, string statics", "m",
         "length of each dropper of a span by string statics in the vertical plane"),
        ("dropper_length_bending_m", "Dropper length with bending", "m",
         "length of each dropper of a span, with the bending stiffness of the wires"),
    ),
    *_define(
        "static", "initial state of a line with stagger",
        ("dropper_length_stagger_m", "Dropper length with bending and stagger", "m",
         "length of each inclined dropper of a span, with bending stiffness and stagger"),
    ),
    *_define(
        "static", "static check",
        ("elasticity_mm_N", "Elasticity, largest", "mm/N",
         "largest uplift per force along a span, for a force at which all droppers stay taut"),
        ("elasticity_non_uniformity_pct", "Non-uniformity of the elasticity", "%",
         "(largest - smallest) / (largest + smallest) elasticity along a span"),
        ("elasticity_along_span_mm_N", "Elasticity along a span", "mm/N",
         "uplift per force at equal distances along a span, for a force at which all droppers stay taut"),
        ("elasticity_200_N_mm_N", "Elasticity at 200 N, largest", "mm/N",
         "largest uplift per force along a span for 200 N, with slackening of droppers"),
        ("elasticity_200_N_non_uniformity_pct", "Non-uniformity of the elasticity at 200 N", "%",
         "(largest - smallest) / (largest + smallest) elasticity along a span for 200 N, droppers slackening"),
        ("elasticity_200_N_along_span_mm_N", "Elasticity at 200 N along a span", "mm/N",
         "uplift per force at equal distances along a span for 200 N, with slackening of droppers"),
        ("elasticity_of_spans_mm_N", "Elasticity of each span, largest", "mm/N",
         "largest uplift per force along each span of a line with listed spans, all droppers taut"),
        ("elasticity_non_uniformity_of_spans_pct", "Non-uniformity of the elasticity of each span", "%",
         "(largest - smallest) / (largest + smallest) elasticity along each span of a line with listed spans"),
        ("elasticity_along_line_mm_N", "Elasticity along the line", "mm/N",
         "uplift per force at 24 equal distances in each span of a line with listed spans, all droppers taut"),
        ("elasticity_200_N_of_spans_mm_N", "Elasticity at 200 N of each span, largest", "mm/N",
         "largest uplift per force along each span of a line with listed spans for 200 N, droppers slackening"),
        ("elasticity_200_N_non_uniformity_of_spans_pct", "Non-uniformity of the elasticity at 200 N of each span", "%",
         "(largest - smallest) / (largest + smallest) elasticity along each span for 200 N, droppers slackening"),
        ("elasticity_200_N_along_line_mm_N", "Elasticity at 200 N along the line", "mm/N",
         "uplift per force at 24 equal distances in each span of a line with listed spans for 200 N"),
        ("presag_along_line_mm", "Pre-sag along the line", "mm",
         "sag of the contact wire below the straight lines between its supports, at every dropper of listed spans"),
        ("dropper_length_along_line_m", "Dropper length along the line", "m",
         "length of every dropper of listed spans at rest, with bending stiffness and stagger"),
        ("head_offset_mm", "Largest lateral offset of the contact wire", "mm",
         "largest lateral distance of the contact wire at rest from the centre of a pantograph head, with cant"),
        ("wave_speed_m_s", "Wave speed of the contact wire", "m/s", "speed of transverse waves on the contact wire"),
        ("reflection_coefficient", "Reflection coefficient of a dropper", "",
         "share of a contact-wire wave that a dropper reflects: sqrt(T m) of the messenger over that of both"),
        ("doppler_factor", "Doppler factor", "", "(c - v) / (c + v) with the wave speed c and the train speed v"),
        ("amplification_coefficient", "Amplification coefficient", "", "reflection coefficient over Doppler factor"),
        ("natural_frequency_Hz", "First natural frequencies", "Hz",
         "first natural frequencies of up to ten spans of the line, for modes of mainly vertical motion"),
    ),
    *_define(
        "static", "pantograph model",
        ("apparent_mass_kg", "Apparent mass at the pantograph's head", "kg",
         "magnitude of the apparent mass (force over acceleration) at the head of each pantograph, "
         "at the frequencies of the case"),
    ),
    *_define(
        "static", "wave speed",
        ("speed_over_wave_speed", "Speed over wave speed", "",
         "train speed over the speed of transverse waves on the contact wire"),
    ),
    *_define(
        "mass_drop", "mass-drop record",
        ("mode_frequency_Hz", "Mode frequency", "Hz", "frequency of a mode, or of a group of modes"),
        ("damping_ratio", "Damping ratio", "", "damping ratio of a mode, or of a group of modes"),
    ),
    *_define(
        "mass_drop", "modes identified from mass drops",
        ("modes_in_group", "Modes in a group", "", "number of identified modes in a group of span modes"),
        ("largest_damping_ratio", "Largest damping ratio", "",
         "largest damping ratio of the modes identified with certainty"),
        ("damping_decrease_pct", "Decrease of damping over the first three groups", "%",
         "decrease of the median damping ratio between groups: the smaller of groups 1 to 2 and 2 to 3"),
        ("largest_damping_decrease_pct", "Largest decrease of damping over the first three groups", "%",
         "decrease of the median damping ratio between groups: the larger of groups 1 to 2 and 2 to 3"),
        ("damping_variation_pct", "Variation of damping from the third group to 6 Hz", "%",
         "largest deviation of the median damping ratio of a later group up to 6 Hz from that of group 3"),
        ("reference_over_identified_damping", "Damping of the reference model over the identified one", "",
         "damping ratio of the initial model at the frequency of a mode over its identified ratio; "
         "median of each group of span modes"),
        ("damping_dispersion_correlation", "Dispersion of damping over tests against frequency", "",
         "rank correlation of the interquartile range of the damping ratios of all tests, each identified on its own, "
         "with the group of span modes: -1, if it always decreases"),
        ("outliers_above_pct", "Outliers of damping over tests that overestimate", "%",
         "share of the outliers of the damping ratios of all tests that lie above the box of their group"),
        ("identification_scatter_correlation", "Scatter of the identification against frequency", "",
         "rank correlation of the standard deviation of the damping ratio, median of each group over all tests, with "
         "the group of span modes: -1, if it always decreases"),
        ("smallest_phase_collinearity", "Smallest modal phase collinearity", "",
         "modal phase collinearity of the certain modes, 1 for a normal mode; the smallest"),
        ("repeat_correlation", "Correlation of repeated drops", "",
         "correlation of a drop with its repeat, smallest of all channels: at the start, and a minute later"),
        ("half_power_record_s", "Record length for points in a half-power band", "s",
         "record length that gives a number of spectral lines inside the half-power band of a mode, N / (2 zeta f)"),
        ("group_merging_Hz", "Frequency above which groups are not separate", "Hz",
         "middle of the lowest gap between two groups of span modes that is smaller than the mean of their widths"),
        ("lateral_modes_in_group", "Lateral modes in a group", "",
         "number of computed lateral modes in a group, on the line with a stagger"),
        ("observable_wire_coefficients", "Observable coefficients of the wires", "",
         "number of Rayleigh coefficients of contact and messenger wire that the identified modes determine"),
        ("observable_other_coefficients", "Observable coefficients of other components", "",
         "number of Rayleigh coefficients of droppers, steady arms and supports that the identified modes determine"),
        ("damping_rise_pct", "Rise of damping from the third group to 6 Hz", "%",
         "rise of the highest median damping ratio between group 4 and 6 Hz over the median of group 3"),
    ),
    *_define(
        "study", "modes identified from mass drops",
        ("damping_gain_pct", "Gain of damping by a damper at the steady arms", "%",
         "gain of the median damping ratio by dampers at the steady-arm clamps, one value per frequency band"),
        ("damping_gain_ratio", "Gain of damping over that of the first group", "",
         "gain of damping in a frequency band over the gain in the first band; it does not depend on the damper"),
        ("damping_gain_step", "Growth of that gain over the first three groups", "",
         "gain of damping in a group over that in the group before; the smaller of groups 2 and 3"),
        ("damping_gain_correlation", "Gain of damping against frequency", "",
         "rank correlation of the gain with the number of the band from the second one on: -1, if it always decreases"),
        ("damping_gain_end_Hz", "End of the gain of damping", "Hz",
         "frequency above which 10 % of the largest gain of damping remain, interpolated between the bands"),
    ),
    *_define(
        "pantograph", "two runs of a train",
        *(
            (f"change_cov_{cutoff}_pct", f"Change of the coefficient of variation, 0–{cutoff} Hz", "%",
             f"change of the coefficient of variation of the contact force in 0-{cutoff} Hz "
             "from the previous damping model to the damping of the case")
            for cutoff in (20, 50)
        ),
        *(
            (f"change_{band.quantity.removesuffix('_N')}_pct", f"Change of RMS, {band.low:g}–{band.high:g} Hz", "%",
             f"change of the RMS of the contact force in {band.low:g}-{band.high:g} Hz "
             "from the previous damping model to the damping of the case")
            for band in BANDS
        ),
        ("earlier_rms_20_50_N", "RMS, 20–50 Hz, previous damping", "N",
         "RMS of the contact force in 20-50 Hz under the previous damping model"),
    ),
    *_define(
        "study", "two runs of a train",
        ("rear_over_front_change_20_50_pct", "Change of RMS, 20–50 Hz, rear less front", "%",
         "change of the RMS in 20-50 Hz of the last pantograph minus the change of the first [points]"),
        *(
            (f"{end}_rear_over_front_{band.quantity.removesuffix('_N')}",
             f"RMS, {band.low:g}–{band.high:g} Hz, rear over front, {end}", "",
             f"RMS in {band.low:g}-{band.high:g} Hz of the last pantograph over that of the first, "
             f"in the run with the {order} ratio")
            for band in BANDS for end, order in (("largest", "larger"), ("smallest", "smaller"))
        ),
    ),
    *_define(
        "study", "drops under several damping models",
        ("modal_velocity_difference_pct", "Velocity with modal damping against Rayleigh damping", "%",
         "RMS of the difference between the velocities with Rayleigh damping and with modal damping besides, "
         "over the RMS of the former; one value per window"),
        ("reference_residual_velocity_ratio", "Residual velocity of the reference model", "",
         "RMS of the velocity in the last window under the reference model, over that of the record"),
        ("medium_frequency_velocity_ratio", "Velocity in 5–20 Hz against the reference model", "",
         "RMS of the velocity in 5-20 Hz in the first window with Rayleigh damping, over that of the reference model"),
    ),
    *_define(
        "study", "runs with several coefficients",
        ("dropper_transition_start_s", "Onset of the dropper transition", "s",
         "smallest stiffness coefficient that changes the largest compensation force of a dropper by 10 %"),
        ("dropper_transition_end_s", "End of the dropper transition", "s",
         "stiffness coefficient above which 10 % of the largest compensation force of a dropper remains"),
        ("dropper_oscillation_pct", "High-frequency oscillation of an undamped dropper", "%",
         "RMS of the velocity of the dropper's extension above 50 Hz in the first 0.1 s after a release, over that of "
         "the contact wire at the dropper"),
        ("dropper_oscillation_decay_ratio", "Oscillation left by more dropper damping", "",
         "share of that velocity after 0.8 s to 1.6 s, over the share with the next smaller stiffness coefficient; the "
         "largest of all coefficients"),
        ("dropper_velocity_change_pct", "Change of the velocity by dropper damping", "%",
         "RMS of the change of the velocity of the contact wire at the dropper against no damping, over its RMS; one "
         "value per stiffness coefficient"),
        ("dropper_force_change_pct", "Change of the contact force by small dropper damping", "%",
         "largest change of the RMS of the contact force in a band, of any pantograph, from the smallest stiffness "
         "coefficient to that of the case"),
        ("dropper_locked_force_pct", "Force left when the dropper is locked", "%",
         "largest compensation force at the largest stiffness coefficient, over its value without damping"),
    ),
)
# fmt: on
"""Quantities that are not computed from a record, in the order of reports."""


QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        *PANTOGRAPH_QUANTITIES,
        *STATED_QUANTITIES,
        *OVERLAP_QUANTITIES,
        *LINE_QUANTITIES,
        *DELIVERED_QUANTITIES,
    )
}
"""All quantities, in the order of reports."""


def unit_of(name: str) -> str:
    """Unit of a quantity; empty if it is not known, as in a baseline of another version."""
    return QUANTITIES[name].unit if name in QUANTITIES else ""


def list_table_quantities(table: QuantityTable) -> list[str]:
    """Names of the quantities in a fixed table, in the order of reports."""
    return [quantity.name for quantity in QUANTITIES.values() if table in quantity.tables]
