"""Quantities that a study delivers: of identified modes, and of the comparison of several runs."""

from pantocheck.conformance.quantities.quantity import Quantity

_MODES, _PASSAGES, _DROPPERS = (
    "modes identified from mass drops",
    "two runs of a train",
    "runs with several coefficients",
)


def _change(name: str, band: str) -> Quantity:
    definition = f"change of the contact force's RMS in {band} from the damping before to that of the case"
    return Quantity(name, "%", definition, _PASSAGES, "pantograph")


STUDY_QUANTITIES: tuple[Quantity, ...] = (
    Quantity("modes_in_group", "", "number of identified modes in a group of span modes", _MODES, "mass_drop"),
    Quantity("largest_damping_ratio", "", "largest damping ratio of any certain mode", _MODES, "mass_drop"),
    Quantity(
        "damping_decrease_pct",
        "%",
        "decrease of the group medians of damping, the smaller one of group 1 to 2 and group 2 to 3",
        _MODES,
        "mass_drop",
    ),
    Quantity(
        "damping_rise_pct",
        "%",
        "how far the highest group median of damping between group 4 and 6 Hz lies over that of group 3",
        _MODES,
        "mass_drop",
    ),
    Quantity(
        "damping_gain_pct",
        "%",
        "gain of the median damping ratio by a damper at the steady arms' claws, one value per frequency band",
        _MODES,
        "study",
    ),
    Quantity(
        "damping_gain_fading_pct",
        "%",
        "gain of damping in the second group less that in the last band",
        _MODES,
        "study",
    ),
    _change("change_rms_0_5_pct", "0-5 Hz"),
    _change("change_rms_5_20_pct", "5-20 Hz"),
    _change("change_rms_20_50_pct", "20-50 Hz"),
    Quantity(
        "rear_over_front_change_20_50_pct",
        "%",
        "change of the RMS in 20-50 Hz of the last pantograph less that of the first, in percentage points",
        _PASSAGES,
        "study",
    ),
    Quantity(
        "dropper_transition_start_s",
        "s",
        "smallest stiffness coefficient at which a dropper's largest compensation force has changed by 10 %",
        _DROPPERS,
        "study",
    ),
    Quantity(
        "dropper_transition_middle_s",
        "s",
        "stiffness coefficient above which half of a dropper's largest compensation force is left",
        _DROPPERS,
        "study",
    ),
    Quantity(
        "dropper_transition_end_s",
        "s",
        "stiffness coefficient above which 10 % of a dropper's largest compensation force is left",
        _DROPPERS,
        "study",
    ),
    Quantity(
        "dropper_locked_force_pct",
        "%",
        "largest compensation force at the largest stiffness coefficient over that without damping",
        _DROPPERS,
        "study",
    ),
)
