"""The package of docs/extending.md, built and installed like any other distribution."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin"


@pytest.mark.thorough
def test_the_example_is_built_installed_and_used(tmp_path: Path) -> None:
    source = tmp_path / "source"
    source.mkdir()
    for path in EXAMPLE.rglob("*"):  # a build writes into the folder of its sources
        if path.is_file() and path.suffix in (".py", ".toml"):
            copied = source / path.relative_to(EXAMPLE)
            copied.parent.mkdir(parents=True, exist_ok=True)
            copied.write_bytes(path.read_bytes())
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", tmp_path / "site", source]
    subprocess.run(pip, check=True, timeout=300)  # the build system of pyproject.toml comes from the package index
    folders = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), str(tmp_path / "site")]))
    code = "from pantocheck.conformance.command_line import main; main()"
    arguments = ["run", "own/acme-lines/fast", "--system", "acme-sine:20", "--formats", "json"]
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": folders},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (done.returncode, done.stdout.split()[0]) == (1, "UNVERIFIED"), done.stderr
    assert "distribution" in (tmp_path / "report" / "results.json").read_text("utf-8")
