"""`runs import` and `runs assess`: files of the output, equal tables of one process, several ones and a cluster."""

import csv
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.measured_runs import FORCE_PROFILE, write_run

pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four runs of 1.5 km, two of them without a broken dropper; the last file is refused."""
    folder = tmp_path_factory.mktemp("logger")
    (folder / "force.toml").write_text(FORCE_PROFILE, encoding="utf-8")
    files = [
        write_run(folder, f"run{day}", ends_km=(10.0, 11.5), day=day, seed=day, dip_km=10.7 if day > 2 else None)
        for day in (1, 2, 3, 4)
    ]
    damaged = write_run(folder, "damaged", ends_km=(10.0, 10.1))
    damaged.write_text("", encoding="utf-8")
    result = pantocheck("runs", "import", *files, damaged, "--out", folder / "runs")
    assert result.exit_code == 2
    assert "4 runs imported, 1 refused" in result.output
    return folder / "runs"


def assess(runs: Path, out: Path, *options: str) -> dict[str, bytes]:
    """Files of an assessment."""
    arguments = ("--profile", runs.parent / "force.toml", "--section-km", "0.5", "--out", out)
    result = pantocheck("runs", "assess", runs, *arguments, *options)
    assert result.exit_code == 1, result.output
    return list_files(out)


def list_files(out: Path) -> dict[str, bytes]:
    return {str(path.relative_to(out)): path.read_bytes() for path in out.rglob("*") if path.is_file()}


def test_every_file_is_written_and_a_failure_ends_with_one(runs: Path, tmp_path: Path) -> None:
    files = assess(runs, tmp_path / "net")
    names = [json.loads(path.read_text())["run"] for path in runs.glob("line=*/*/*/*/import.json")]
    assert set(files) == {"index.html", "network.json", "passages.csv", *(f"runs/{name}.html" for name in names)}
    results = json.loads(files["network.json"])
    assert (results["verdict"], results["runs"], results["passages"]) == ("fail", 4, 12)
    assert results["reason"].endswith("1 files refused")
    rows = list(csv.DictReader(files["passages.csv"].decode().splitlines()))
    assert {(row["from_km"], row["verdict"]) for row in rows} == {
        *((km, "pass") for km in ("10.0", "10.5", "11.0")),
        ("10.5", "fail"),
    }


def test_processes_give_the_files_of_one_process(runs: Path, tmp_path: Path) -> None:
    assert assess(runs, tmp_path / "two", "--jobs", "2") == assess(runs, tmp_path / "one")


def test_an_assessment_killed_at_random_times_is_repeated(runs: Path, tmp_path: Path) -> None:
    """Killed three times, and forces left in a temporary folder: the next assessment gives the same files."""
    whole, out = assess(runs, tmp_path / "one"), tmp_path / "net"
    arguments = ["--profile", runs.parent / "force.toml", "--section-km", "0.5", "--out", out]
    command = [sys.executable, "-m", "pantocheck", "runs", "assess", runs, *arguments]
    for delay in np.random.default_rng(37).uniform(0.0, 0.5, 3):
        with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            while process.poll() is None and not out.is_dir():
                time.sleep(0.01)
            time.sleep(delay)
            process.kill()
    (out / ".forces-killed").mkdir()
    (out / ".forces-killed" / "0.npy").touch()
    assert {name: text for name, text in assess(runs, out).items() if not name.startswith(".")} == whole
    assert not list(out.glob(".forces-*"))


def test_queries_of_the_page_read_a_collection_and_its_passages(runs: Path, tmp_path: Path) -> None:
    """A sine of 28 N has a sigma of 19.8 N, and noise of 3 N makes it 20.0 N; the dip on two days adds 1 N."""
    duckdb = pytest.importorskip("duckdb", reason="duckdb is not installed")
    assess(runs, tmp_path / "net")
    page = (Path(__file__).parents[4] / "docs" / "network.md").read_text(encoding="utf-8")
    samples, passages = (
        duckdb.sql(query.replace("'runs/", f"'{runs}/").replace("'net/", f"'{tmp_path}/net/")).fetchall()
        for query in re.findall(r"```sql\n(.*?)```", page, re.DOTALL)
    )
    assert [str(row[2]) for row in samples] == [f"2026-05-0{day}" for day in (1, 2, 3, 4)]
    assert [round(1000 * row[5]) for row in samples] == [20, 20, 21, 21]
    assert [row[4] for row in samples] == pytest.approx([0.1] * 4, abs=0.0006)
    assert sorted(row[2] for row in passages) == [10.0, 10.5, 11.0]
    assert {row[6] for row in passages} == {4}


@pytest.mark.thorough
def test_a_cluster_gives_the_files_of_one_process(runs: Path, tmp_path: Path) -> None:
    """In a process of its own: the threads of Dask would outlive the test."""
    pytest.importorskip("distributed")
    arguments = [
        "--profile",
        str(runs.parent / "force.toml"),
        "--section-km",
        "0.5",
        "--out",
        str(tmp_path / "cluster"),
    ]
    command = [sys.executable, "-m", "helpers.dask_network", str(runs), *arguments]
    settings = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, env=settings, timeout=300, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert list_files(tmp_path / "cluster") == assess(runs, tmp_path / "one")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--by", "section,weather"], "option --by: found 'weather'"),
        (["--profile", "line-test"], "compares with a measured record"),
    ],
)
def test_wrong_options_are_named(options: list[str], message: str, runs: Path, tmp_path: Path) -> None:
    given = ["--profile", "acceptance-ac", "--out", str(tmp_path / "net"), *options]
    result = pantocheck("runs", "assess", runs, *given)
    assert result.exit_code == 2
    assert message in result.output
    assert not (tmp_path / "net").exists()
