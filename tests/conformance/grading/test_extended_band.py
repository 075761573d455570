"""What a certificate says of the band above 20 Hz."""

from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.grading.extended_band import NOT_VALIDATED
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.runner import run_cases


def rippled(wave, case, amplitude):
    """The record with a ripple of 35 Hz [N]."""
    record = wave().record(case)
    return replace(record, force=record.force + amplitude * np.sin(2 * np.pi * 35.0 * record.time))


def warnings(wave, case, fine, **run):
    @dataclass(frozen=True)
    class Rippled(wave):
        def run(self, case):
            refined = None if fine is None else Delivered(rippled(wave, case, fine))
            return Delivered(rippled(wave, case, 10.0), run=RunTable(**run), refined=refined)

    (result,) = run_cases([case], Rippled()).cases
    return [text for text in result.warnings if text.startswith("20-50 Hz")]


def test_lumped_models_are_never_validated_up_there(case_250, wave):
    assert warnings(wave, case_250, 10.0) == [NOT_VALIDATED]


def test_a_mesh_that_does_not_resolve_the_band_is_named(case_250, wave):
    """A ripple of 10 N that is 10.6 N on the finer mesh: 6 %, above the 5 % that are allowed."""
    _, unresolved = warnings(wave, case_250, 10.6)
    assert "the RMS of pantograph 1 from 7.04 N to 7.46 N" in unresolved
    assert len(warnings(wave, case_250, 10.4)) == 1


def test_without_a_finer_run_nothing_shows_that_the_band_is_resolved(case_250, wave):
    assert warnings(wave, case_250, None, dt_s=0.001)[1:] == [
        "20-50 Hz: no run with a finer mesh and time step (time step 0.001 s) shows whether the band is resolved"
    ]


def test_no_warning_where_there_is_no_such_band(case_250, wave):
    """A force delivered filtered at 20 Hz has no numbers above: they are skipped, with the reason."""

    @dataclass(frozen=True)
    class Filtered(wave):
        def run(self, case):
            return Delivered(replace(wave().record(case), filter_applied_Hz=20.0))

    (result,) = run_cases([case_250], Filtered()).cases
    assert not [text for text in result.warnings if text.startswith("20-50 Hz")]
    assert "20 Hz" in result.skipped["1"]["rms_20_50_N"]
