"""The page on signatures: the commands of the test authority work as printed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from helpers.graded_wave import render_document
from pantocheck.conformance.results.results_format import Results

PAGE = Path(__file__).parents[2] / "docs" / "signing.md"


@pytest.mark.thorough
@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
@pytest.mark.skipif(shutil.which("bash") is None, reason="the commands are those of a shell")
def test_commands_of_the_test_authority(accepted_wave: Results, tmp_path: Path) -> None:
    pytest.importorskip("pyhanko", reason="extra sign")
    (tmp_path / "report").mkdir()
    for name in ("certificate.pdf", "results.json"):
        (tmp_path / "report" / name).write_bytes(render_document(accepted_wave.to_dict(), name))
    commands = PAGE.read_text(encoding="utf-8").split("## A test authority")[1].split("```sh\n")[1].split("```")[0]
    program = f"{sys.executable} -c 'from pantocheck.conformance.app.main import main; main()'"
    script = f'set -e\npantocheck() {{ {program} "$@"; }}\n{commands}'
    folder = str(Path(sys.executable).parent)
    done = subprocess.run(
        ["bash", "-c", script], cwd=tmp_path, env=os.environ | {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True, check=False, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "\nauthentic: the verdict 'pass' follows" in done.stdout
    output = " ".join(done.stdout.split())
    assert "signed by Test author as author (trusted: its chain leads to Test authority)" in output
    assert "signed by Test assessor as assessor (trusted" in output
    assert (tmp_path / "report" / "results.json.p7s").exists()
