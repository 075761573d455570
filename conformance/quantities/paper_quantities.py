"""Quantities of the studies after Vo Van, Balmes and Lorang (2015): identified modes and comparisons of runs."""

from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.quantity import Quantity

PAPER_QUANTITIES: tuple[Quantity, ...] = (
    Quantity(
        name="modes_in_group",
        label="Modes in a group",
        unit="",
        definition="number of identified modes in a group of span modes",
        needs="modes identified from mass drops",
        scope="mass_drop",
    ),
    Quantity(
        name="largest_damping_ratio",
        label="Largest damping ratio",
        unit="",
        definition="largest damping ratio of the modes identified with certainty",
        needs="modes identified from mass drops",
        scope="mass_drop",
    ),
    Quantity(
        name="damping_decrease_pct",
        label="Decrease of damping over the first three groups",
        unit="%",
        definition="decrease of the median damping ratio between groups: the smaller of groups 1 to 2 and 2 to 3",
        needs="modes identified from mass drops",
        scope="mass_drop",
    ),
    Quantity(
        name="damping_rise_pct",
        label="Rise of damping from the third group to 6 Hz",
        unit="%",
        definition="rise of the highest median damping ratio between group 4 and 6 Hz over the median of group 3",
        needs="modes identified from mass drops",
        scope="mass_drop",
    ),
    Quantity(
        name="damping_gain_pct",
        label="Gain of damping by a damper at the steady arms",
        unit="%",
        definition="gain of the median damping ratio by dampers at the steady-arm clamps, one value per frequency band",
        needs="modes identified from mass drops",
        scope="study",
    ),
    Quantity(
        name="damping_gain_fading_pct",
        label="Fading of that gain with frequency",
        unit="%",
        definition="gain of damping in the second group minus the gain in the last band",
        needs="modes identified from mass drops",
        scope="study",
    ),
    *(
        Quantity(
            name=f"change_{band.quantity.removesuffix('_N')}_pct",
            label=f"Change of RMS, {band.low:g}–{band.high:g} Hz",
            unit="%",
            definition=f"change of the RMS of the contact force in {band.low:g}-{band.high:g} Hz "
            "from the previous damping model to the damping of the case",
            needs="two runs of a train",
            scope="pantograph",
        )
        for band in BANDS
    ),
    Quantity(
        name="rear_over_front_change_20_50_pct",
        label="Change of RMS, 20–50 Hz, rear less front",
        unit="%",
        definition="change of the RMS in 20-50 Hz of the last pantograph minus the change of the first [points]",
        needs="two runs of a train",
        scope="study",
    ),
    Quantity(
        name="dropper_transition_start_s",
        label="Onset of the dropper transition",
        unit="s",
        definition="smallest stiffness coefficient that changes the largest compensation force of a dropper by 10 %",
        needs="runs with several coefficients",
        scope="study",
    ),
    Quantity(
        name="dropper_transition_middle_s",
        label="Middle of the dropper transition",
        unit="s",
        definition="stiffness coefficient above which half of the largest compensation force of a dropper remains",
        needs="runs with several coefficients",
        scope="study",
    ),
    Quantity(
        name="dropper_transition_end_s",
        label="End of the dropper transition",
        unit="s",
        definition="stiffness coefficient above which 10 % of the largest compensation force of a dropper remains",
        needs="runs with several coefficients",
        scope="study",
    ),
    Quantity(
        name="dropper_locked_force_pct",
        label="Force left when the dropper is locked",
        unit="%",
        definition="largest compensation force at the largest stiffness coefficient, over its value without damping",
        needs="runs with several coefficients",
        scope="study",
    ),
)
