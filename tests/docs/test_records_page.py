"""The page on records: its program runs, and its messages are those that are printed."""

import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.docs_pages import list_blocks
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.records.record_reading import open_record, read_record

blocks = partial(list_blocks, "records.md")


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder in which the program of the page has run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "write_record.py").write_text(blocks("python")[0])
    subprocess.run([sys.executable, "write_record.py"], check=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    return tmp_path


def test_program_writes_a_record_that_can_be_graded(written: Path, tmp_path: Path) -> None:
    record, sidecar = read_record(written / "my250.toml")
    assert sidecar.case == "en50318-2002/250"
    assert record.rate == pytest.approx(1000)
    done = CliRunner().invoke(app, ["run", "en50318-2002/250", "--system", "record:.", "--formats", "html,json"])
    assert done.exit_code == 1
    assert re.search(r"FAIL min_force_N: ", done.output)
    assert "the record has no uplift at supports" in done.output
    assert (written / "report" / "certificate.html").exists()
    assert "pantocheck run en50318-2002/250 --system record:. --out report" in blocks("sh")[0]
    (tmp_path / "s.toml").write_text(blocks("toml")[0])
    assert open_record(tmp_path / "s.toml").quantities == {"max_uplift_at_support_mm": 52.2}


def test_matlab_program_writes_the_same_sidecar(written: Path) -> None:
    """MATLAB is not available here, so the text of its program is compared."""
    (matlab,) = blocks("matlab")
    assert "time_s,position_1_m,force_1_N" in matlab
    for line in (written / "my250.toml").read_text().splitlines():
        assert f"'{line}'" in matlab
    assert len(matlab.splitlines()) <= 11


def test_messages_of_the_page_are_those_that_are_printed(written: Path) -> None:
    (messages,) = blocks("")
    table, sidecar = written / "my250.csv", written / "my250.toml"
    samples, keys = table.read_text(), sidecar.read_text()
    lines = samples.splitlines()
    lines[4] = lines[4].rpartition(",")[0] + ",abc"
    for table_text, sidecar_text in (
        ("\n".join(lines), keys),
        (samples.replace("force_1_N", "force_1_lbf"), keys),
        (samples, keys.replace("speed_km_h = 250.0", "speed_m_s = 69.444444444444444")),
    ):
        table.write_text(table_text)
        sidecar.write_text(sidecar_text)
        with pytest.raises(InputError) as caught:
            read_record(sidecar)
        assert str(caught.value) in messages
