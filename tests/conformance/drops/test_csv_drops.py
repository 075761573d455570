"""CSV records of mass drops: round trip, decimal dialects, names of channels."""

from dataclasses import replace
from pathlib import Path

import pytest

from helpers.drop_records import assert_same_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import select_drop_writer, write_drop_csv


def test_csv_reads_back(tmp_path: Path, record: DropRecord) -> None:
    """CSV is written with nine digits."""
    write_drop_csv(record, tmp_path / "r.csv")
    assert_same_record(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)


@pytest.mark.parametrize("name", ["S1,z", "S1;z", 'S1"z', "S1'z", "S1\nz", "S1_z\n", "S1\u2028z", "S1\tz"])
def test_names_that_no_head_line_can_hold_are_refused(tmp_path: Path, record: DropRecord, name: str) -> None:
    """Neither the file nor its sidecar is left behind."""
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    with pytest.raises(InputError, match="this name is not possible in the head line"):
        write_drop_csv(named, tmp_path / "r.csv")
    assert not list(tmp_path.iterdir())


def test_decimal_commas(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    text = (tmp_path / "r.csv").read_text()
    (tmp_path / "r.csv").write_text(text.replace(",", ";").replace(".", ","))
    assert_same_record(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)


@pytest.mark.parametrize("name", ["plan.csv", "plan.uff"])
def test_sidecar_replaces_no_other_file(tmp_path: Path, record: DropRecord, name: str) -> None:
    """A case `plan.toml` beside the record `plan.csv` stays; a sidecar of an earlier record is replaced."""
    case, write = tmp_path / "plan.toml", select_drop_writer(Path(name))
    case.write_text('id = "own/plan"\n[mass_drop]\n')
    with pytest.raises(InputError, match=r"would overwrite plan\.toml"):
        write(record, tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.toml"]
    assert case.read_text() == 'id = "own/plan"\n[mass_drop]\n'
    case.write_text('[test]\nname = "earlier"\n[drop]\n')
    write(record, tmp_path / name)
    assert "earlier" not in case.read_text()
