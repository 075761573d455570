"""Identity in an assessment: copies of a record, copies of a profile, limits that a limits file weakens, scope."""

import hashlib
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable

LINE_TEST = load_profile("line-test")


@pytest.fixture
def record(wave: Any, two_pantograph_case: Case) -> Record:
    """Record of two pantographs; the rear one has another force than the front one."""
    # The run-in of 150 m before the first support holds its rest, the run-out the passage of the last one.
    file = two_pantograph_case.file.model_copy(update={"start_m": -90.0, "run_out_m": 65.0})
    record: Record = wave().record(replace(two_pantograph_case, file=file))
    return replace(record, force=record.force * np.array([[1.0], [1.05]]))


def load(path: Path, record: Record) -> AssessedRecord:
    return load_assessed_record(write_record(path, record), LINE_TEST, LineTable(span_m=60.0))


def test_independent_records_are_compared_and_have_their_digests(record: Record, tmp_path: Path) -> None:
    """A measured force that differs by 0.1 % is not a copy."""
    measured = load(tmp_path / "measured.csv", replace(record, force=1.001 * record.force))
    results = assess_record(load(tmp_path / "simulated.csv", record), LINE_TEST, "provisional", measured)
    assert [step.state for step in results.scope if step.step == "line_test"] == ["done"]
    assert results.cases[0].steps == ["line_test"]
    facts = results.cases[0].record
    for digest, name in ((facts.digest, "simulated"), (facts.measured_digest, "measured")):
        files = (tmp_path / f"{name}.toml", tmp_path / f"{name}.csv")
        parts = "\n".join(hashlib.sha256(file.read_bytes()).hexdigest() for file in files)
        assert digest == f"sha256:{hashlib.sha256(parts.encode()).hexdigest()}"


@pytest.mark.parametrize("suffix", ["csv", "h5"])
def test_copy_under_another_name_or_format_is_refused(record: Record, tmp_path: Path, suffix: str) -> None:
    measured = load(tmp_path / f"measured.{suffix}", record)
    with pytest.raises(InputError, match="is that of simulated: one record is a copy of the other"):
        assess_record(load(tmp_path / "simulated.csv", record), LINE_TEST, measured=measured)


def test_copied_force_of_one_pantograph_or_with_another_sidecar_is_refused(record: Record, tmp_path: Path) -> None:
    copied = replace(record, force=record.force * np.array([[1.001], [1.0]]))
    measured = load(tmp_path / "measured.csv", copied)
    with pytest.raises(InputError, match="contact force of pantograph 2"):
        assess_record(load(tmp_path / "simulated.csv", record), LINE_TEST, measured=measured)
    # Another analysis section gives other statistics of the same force.
    simulated = load(tmp_path / "simulated.csv", record)
    shutil.copy(tmp_path / "simulated.csv", tmp_path / "measured.csv")
    sidecar = shutil.copy(tmp_path / "simulated.toml", tmp_path / "measured.toml")
    edit_toml(Path(sidecar), {"file": "measured.csv", "evaluated_m": [240.0, 300.0]})
    measured = load_assessed_record(Path(sidecar), LINE_TEST, LineTable())
    with pytest.raises(InputError, match="one record is a copy of the other"):
        assess_record(simulated, LINE_TEST, measured=measured)


def test_profile_with_a_library_name_and_other_rules_is_a_modified_copy(record: Record, tmp_path: Path) -> None:
    profile = load_profile("acceptance-ac")
    subject = load(tmp_path / "train.csv", record)
    wide = profile.rule[0].model_copy(update={"trust": "provisional"})
    copies = {
        "identical": profile,
        "modified": profile.model_copy(update={"rule": (wide, *profile.rule[1:])}),
        "own": profile.model_copy(update={"name": "mine"}),
    }
    cases = {name: assess_record(subject, copy).cases[0] for name, copy in copies.items()}
    assert {name: case.library for name, case in cases.items()} == {name: name for name in copies}
    assert cases["own"].limits_digest == cases["identical"].limits_digest != cases["modified"].limits_digest


def test_limit_that_replaces_a_rule_by_a_weaker_one_is_named(record: Record, tmp_path: Path) -> None:
    """The rule holds for both pantographs; the user's limit replaces that of the second one only."""
    limit = Limit(quantity="cov_20", pantograph=2, upper=0.9, trust="provisional", source="own")
    subject = load(tmp_path / "train.csv", record)
    case = assess_record(subject, load_profile("acceptance-ac"), limits=[limit]).cases[0]
    assert case.limit_changes == [
        "cov_20 of pantograph 2: the limit <= 0.3 is widened to <= 0.9, and the trust of the limit is lowered from "
        "secondary to provisional"
    ]
    assert case.limits_digest != case.stated_limits_digest
