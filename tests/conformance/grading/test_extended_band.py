"""Caveats for the 20-50 Hz band."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from helpers.section_lines import section_line
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.validity_warnings import NOT_VALIDATED, validity_warnings
from pantocheck.conformance.line.elements.tension_section import SectionTable, SectionWire
from pantocheck.conformance.pantograph.pantograph_file import MatricesTable, ModesTable
from pantocheck.conformance.quantities.evaluation import Evaluation
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs.system import Delivered


def rippled(wave: type[Wave], case: Case, amplitude: float) -> Record:
    """The record with a ripple of 35 Hz [N]."""
    record = wave().record(case)
    return replace(record, force=record.force + amplitude * np.sin(2 * np.pi * 35.0 * record.time))


def warnings(wave: type[Wave], case: Case, fine: float | None, **run: Any) -> list[str]:
    @dataclass(frozen=True)
    class Rippled(Wave):
        def run(self, case: Case) -> Delivered:
            refined = None if fine is None else Delivered(rippled(wave, case, fine))
            return Delivered(rippled(wave, case, 10.0), run=RunTable(**run), refined=refined)

    (result,) = run_cases([case], Rippled()).cases
    return [text for text in result.warnings if text.startswith("20-50 Hz")]


def test_lumped_models_and_unresolved_meshes_give_a_warning(case_250: Case, wave: type[Wave]) -> None:
    assert warnings(wave, case_250, 10.0) == [NOT_VALIDATED]
    # A ripple of 10 N is 10.6 N on the finer mesh: 6 %, above the accepted 5 %.
    _, unresolved = warnings(wave, case_250, 10.6)
    assert "the RMS of pantograph 1 from 7.04 N to 7.46 N, by more than 5 %: " in unresolved
    assert len(warnings(wave, case_250, 10.4)) == 1
    assert warnings(wave, case_250, None, dt_s=0.001)[1:] == [
        "20-50 Hz: no run with a finer mesh and time step (time step 0.001 s) shows whether the band is resolved"
    ]


def test_record_without_the_band_has_no_warning(case_250: Case, wave: type[Wave]) -> None:
    """A force filtered at 20 Hz has no values above: they are skipped with the reason."""

    @dataclass(frozen=True)
    class Filtered(Wave):
        def run(self, case: Case) -> Delivered:
            return Delivered(replace(wave().record(case), filter_applied_Hz=20.0))

    (result,) = run_cases([case_250], Filtered()).cases
    assert not [text for text in result.warnings if text.startswith("20-50 Hz")]
    assert "20 Hz" in result.skipped["1"]["rms_20_50_N"]


# Warnings on the limits of validity of a run: speed, working height, lost contact.


NOTHING = Evaluation({}, {})
PROVENANCE = {"trust": "primary", "source": "rig"}


def at_speed(case: Case, share: float) -> Case:
    """The case at a share of sqrt(20 kN / 1.35 kg/m), 121.7 m/s."""
    speed = 3.6 * share * np.sqrt(20e3 / 1.35)
    return replace(case, file=case.file.model_copy(update={"speed_km_h": float(speed)}))


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.699, None),
        (0.701, "speed: 307.2 km/h is 70.1 % of the wave speed of the contact wire, 438.2 km/h, above the usual limit"),
        (0.899, "settle slowly: lengthen the run-in"),
        (0.901, "and are no prediction. Choose a higher tension or a lower speed"),
        (1.05, "speed: 460.1 km/h is 105 % of the wave speed"),
    ],
)
def test_speed_near_the_wave_speed(case_250: Case, share: float, text: str | None) -> None:
    found = validity_warnings(at_speed(case_250, share), NOTHING)
    assert [text in warning for warning in found] == ([] if text is None else [True])


def test_speed_is_compared_with_the_slowest_section(case_250: Case) -> None:
    """A section of 10 kN in place of 20 kN: 250 km/h is 81 % of its wave speed of 310 km/h."""
    slow = SectionTable(spans=6, contact_wire=SectionWire(tension_N=10e3))
    line = section_line().model_copy(update={"section": (SectionTable(spans=6), slow)})
    (found,) = validity_warnings(replace(case_250, line=line), NOTHING)
    assert "250 km/h is 80.7 % of the wave speed of the contact wire, 309.8 km/h" in found


@pytest.mark.parametrize(("start", "warned"), [(150.0, False), (180.0, False), (200.0, True), (360.0, False)])
def test_start_in_an_overlap(case_250: Case, start: float, warned: bool) -> None:
    """The overlap extends from 180 m to 360 m."""
    file = case_250.file.model_copy(update={"start_m": start, "evaluated_spans": (7, 8)})
    found = validity_warnings(replace(case_250, line=section_line(), file=file), NOTHING)
    assert ["200 m lies in the overlap from 180 m to 360 m" in warning for warning in found] == [True] * warned


def with_pantograph(case: Case, target: float | None = None, **changes: Any) -> Case:
    use = case.file.pantograph[0].model_copy(update={"target_mean_force_N": target})
    file = case.pantographs[0].model_copy(update=changes)
    return replace(case, pantographs=(file,), file=case.file.model_copy(update={"pantograph": (use,)}))


def chain(case: Case, **changes: Any) -> dict[str, Any]:
    return {"chain": case.pantographs[0].chain.model_copy(update=changes)}


MATRICES = {
    "mass_kg": ((15.0, 0.0), (0.0, 7.2)),
    "damping_N_s_m": ((100.0, -10.0), (-10.0, 10.0)),
    "stiffness_N_m": ((4250.0, -4200.0), (-4200.0, 4200.0)),
    "head": (0.0, 1.0),
    **PROVENANCE,
}
MODES = {"frequency_Hz": (0.9, 7.0), "damping_ratio": (0.2, 0.05), "head_shape": (0.2, 0.3), **PROVENANCE}


@pytest.mark.parametrize("target", [None, 120.0])
def test_working_height_is_named_unless_the_force_is_tuned(case_250: Case, target: float | None) -> None:
    """Base spring k1 of the chain: the static contact force is 120 N times 4200 / (k1 + 4200)."""
    by_matrices = MatricesTable(**MATRICES)
    variants = {
        "carries 50 N per metre of lift": chain(case_250, base_spring_unstretched="wire_height"),
        "is 114.5 N, the uplift force 120 N": chain(case_250, stiffness_N_m=(200.0, 4200.0)),
        "the uplift force acts on the head": {"chain": None, "matrices": by_matrices},
        "as uplift_force_on is not given": {"chain": None, "modes": ModesTable(**MODES)},
    }
    for text, changes in variants.items():
        found = validity_warnings(with_pantograph(case_250, target, **changes), NOTHING)
        assert [text in warning for warning in found] == ([True] if target is None else []), text
        assert all(warning.startswith("working height of pantograph 1: ") for warning in found)


def test_sound_description_or_mechanism_gives_no_number(case_250: Case) -> None:
    """1.2 % for the pantograph of 2002, as a chain and as its matrices."""
    matrices = MatricesTable(**MATRICES, uplift_force_on=(1.0, 0.0))
    assert validity_warnings(case_250, NOTHING) == []
    assert validity_warnings(with_pantograph(case_250, chain=None, matrices=matrices), NOTHING) == []
    # The lowest mass is connected to nothing, so that no static contact force exists.
    free = ((0.0, 0.0), (0.0, 4200.0))
    matrices = MatricesTable(**MATRICES | {"stiffness_N_m": free}, uplift_force_on=(1.0, 0.0))
    assert validity_warnings(with_pantograph(case_250, chain=None, matrices=matrices), NOTHING) == []


def test_negative_minimum_of_the_filtered_force(case_250: Case, wave: type[Wave]) -> None:
    """A force that is zero for 0.1 s in every 0.5 s undershoots after the low-pass."""
    record = wave().record(case_250)
    lost = replace(record, force=np.where(record.time % 0.5 < 0.1, 0.0, record.force))
    result = grade_case(case_250, Delivered(lost), "secondary")
    (text,) = [text for text in result.warnings if text.startswith("contact loss: ")]
    values = result.quantities["1"]
    assert values["min_force_N"] < 0 < values["contact_loss_pct"]
    assert max(loss.duration_s for loss in result.contact_losses["1"]) == pytest.approx(0.1, abs=0.002)
    assert f"pantograph 1 is {values['min_force_N']:.3g} N, lost for {values['contact_loss_pct']:.3g} %" in text
    sound = grade_case(case_250, Delivered(wave().record(case_250)), "secondary")
    assert not [text for text in sound.warnings if text.startswith("contact loss: ")]
