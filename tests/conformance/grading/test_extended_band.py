"""Caveats for the 20-50 Hz band."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.validity_warnings import NOT_VALIDATED
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


def test_lumped_models_are_not_validated_above_20_Hz(case_250: Case, wave: type[Wave]) -> None:
    assert warnings(wave, case_250, 10.0) == [NOT_VALIDATED]


def test_mesh_that_does_not_resolve_the_band_gives_a_warning(case_250: Case, wave: type[Wave]) -> None:
    """A ripple of 10 N is 10.6 N on the finer mesh: 6 %, above the accepted 5 %."""
    _, unresolved = warnings(wave, case_250, 10.6)
    assert "the RMS of pantograph 1 from 7.04 N to 7.46 N" in unresolved
    assert len(warnings(wave, case_250, 10.4)) == 1


def test_missing_refined_run_gives_a_warning(case_250: Case, wave: type[Wave]) -> None:
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
