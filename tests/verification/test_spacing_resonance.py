"""Resonance of the spacing of two pantographs: its frequency in closed form, and its effect on a short line."""

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import library_folder, list_library, load_case
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.tables.spacing_resonance import CASE, first_band, wake_frequency

SPEED_KM_H = 200.0

COARSE = (
    *("line.geometry.spans=14", "evaluated_spans=[9, 12]", "compared_spans=[9, 12]", f"speed_km_h={SPEED_KM_H}"),
    *("discretisation.element_m=1.5", "discretisation.time_step_s=0.003"),
)


def load(*changes: str) -> Case:
    return load_case(list_library(library_folder())[CASE], parse_changes(changes))


def test_highest_frequency_is_that_of_the_joined_wires_between_two_supports() -> None:
    """Neighbouring spans in opposite phase are at rest at the supports, so that f = sqrt(T / m) / (2 L)."""
    # Both wires carry their tensions and masses together. Bending, the masses of the arms, the stiffness of the
    # droppers and their distance change the frequency by less than 1 %.
    line = load().line
    droppers = line.droppers
    lengths = np.array(droppers.length_m)
    hanging = lengths * (droppers.mass_kg_m or 0.0) + droppers.clamp_on_messenger_kg + droppers.clamp_on_contact_kg
    span = line.geometry.longest_span
    mass = line.contact_wire.mass_kg_m + line.messenger_wire.mass_kg_m + hanging.sum() / span
    wave_speed = np.sqrt((line.contact_wire.tension_N + line.messenger_wire.tension_N) / mass)
    phase, frequency = first_band(line)
    assert phase[-1] == pytest.approx(np.pi)
    assert frequency[-1] == pytest.approx(wave_speed / (2 * span), rel=0.01)


def test_rear_pantograph_is_disturbed_at_whole_waves_behind_the_front_one() -> None:
    """One wave v / f behind the front pantograph the standard deviation is twice that at one and a half waves."""
    # It is 39 N against 19 N on the line of 48 spans; half of the difference must remain on a short line with a coarse
    # mesh.
    wave = SPEED_KM_H / 3.6 / wake_frequency(load().line, SPEED_KM_H / 3.6)
    deviations = []
    for waves in (1.0, 1.5):
        case = load(*COARSE, f"spacing_m={waves * wave:.2f}")
        deviations.append(run_case(case, UnrefinedSimulator(), "secondary").quantities["2"]["std_force_N"])
    assert deviations[0] > 1.5 * deviations[1]
