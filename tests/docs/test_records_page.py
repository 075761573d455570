"""The page on records is followed to the letter: its writer is run, its messages are those that are printed."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_summary import read_record_summary

PAGE = (Path(__file__).parents[2] / "docs" / "records.md").read_text(encoding="utf-8")


def blocks(language):
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    return [text for name, text in found if name == language]


@pytest.fixture
def written(tmp_path, monkeypatch):
    """The folder in which the page's writer has run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "write_record.py").write_text(blocks("python")[0])
    subprocess.run([sys.executable, "write_record.py"], check=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    return tmp_path


def test_writer_gives_a_record_that_is_graded(written):
    record, sidecar = read_record(written / "my250.toml")
    assert sidecar.case == "en50318-2002/250"
    assert record.rate == pytest.approx(1000)
    done = CliRunner().invoke(app, ["run", "en50318-2002/250", "--system", "record:.", "--formats", "html,json"])
    assert done.exit_code == 1
    assert re.search(r"min_force_N .* FAIL", done.output)
    assert "the record has no uplift at supports" in done.output
    assert (written / "report" / "certificate.html").exists()


def test_commands_of_the_page_are_those_that_were_run():
    assert "pantocheck run en50318-2002/250 --system record:. --out report" in blocks("sh")[0]


def test_matlab_writes_the_same_sidecar(written):
    """MATLAB is not at hand: its lines must at least print the same names and keys."""
    (matlab,) = blocks("matlab")
    assert "time_s,position_1_m,force_1_N" in matlab
    for line in (written / "my250.toml").read_text().splitlines():
        assert f"'{line}'" in matlab
    assert len(matlab.splitlines()) <= 11


def test_summary_of_the_page_is_read(tmp_path):
    (tmp_path / "s.toml").write_text(blocks("toml")[0])
    assert read_record_summary(tmp_path / "s.toml").quantities == {"max_uplift_at_support_mm": 52.2}


def test_messages_of_the_page_are_those_that_are_printed(written):
    (messages,) = blocks("")
    table, sidecar = written / "my250.csv", written / "my250.toml"
    whole, said = table.read_text(), sidecar.read_text()
    lines = whole.splitlines()
    lines[4] = lines[4].rpartition(",")[0] + ",abc"
    for content, key in (
        ("\n".join(lines), said),
        (whole.replace("force_1_N", "force_1_lbf"), said),
        (whole, said.replace("speed_km_h = 250.0", "speed_m_s = 69.444444444444444")),
    ):
        table.write_text(content)
        sidecar.write_text(key)
        with pytest.raises(InputError) as caught:
            read_record(sidecar)
        assert str(caught.value) in messages


def test_tables_name_every_key_of_the_sidecar():
    from pantocheck.conformance.records.record_sidecar import RecordSidecar

    for name, field in RecordSidecar.model_fields.items():
        assert f"`{field.alias or name}`" in PAGE or f"`[{name}]`" in PAGE
