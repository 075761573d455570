"""Collections: every number of a file is kept, a measurement is one run, and nothing is lost silently."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from helpers.measured_runs import write_run
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn, read_tables
from pantocheck.conformance.grading.assessed_record import hash_force
from pantocheck.conformance.network import run_collection
from pantocheck.conformance.network.run_collection import (
    ImportedFile,
    import_files,
    list_refused,
    list_runs,
    open_collection,
)
from pantocheck.conformance.records.record_reading import read_samples

pytest.importorskip("pyarrow")
from pantocheck.conformance.core.parquet_table import write_parquet_table


def collect(files: list[Path], folder: Path, shared: Path | None = None) -> list[ImportedFile]:
    with open_collection(folder):
        return list(import_files(files, folder, shared))


def list_bytes(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_parquet_keeps_numbers_names_units_and_times(tmp_path: Path) -> None:
    """Equal bit by bit: the preparation of a record is repeated from this table."""
    values = np.array([[0.1, np.nan, 3.0], [1 / 3, 2.0, 1e-300]])
    columns = (TableColumn("F", unit="kN"), TableColumn("F", row=2), TableColumn(None))
    table = MeasuredTable("a.mf4", values, columns, time=np.array([0.0, 0.1]), rate=10.0)
    write_parquet_table(tmp_path / "a.parquet", table)
    (read,) = read_tables(tmp_path / "a.parquet", (), 100)
    np.testing.assert_array_equal(read.values, values)
    np.testing.assert_array_equal(read.time, table.time)
    assert (read.columns, read.rate) == (columns, 10.0)
    with pytest.raises(InputError, match="holds more than 7 numbers"):
        read_tables(tmp_path / "a.parquet", (), 7)


def test_the_same_file_twice_is_one_run_with_the_samples_of_the_file(tmp_path: Path) -> None:
    path = write_run(tmp_path, "a", ends_km=(10.0, 10.2))
    assert [item.state for item in collect([path], tmp_path / "runs")] == ["imported"]
    before = list_bytes(tmp_path / "runs")
    assert [item.state for item in collect([path, path], tmp_path / "runs")] == ["known", "known"]
    assert list_bytes(tmp_path / "runs") == before
    (run,) = list_runs(tmp_path / "runs")
    assert run.sidecar.parent.parent == tmp_path / "runs" / "line=1700" / "track=2" / "date=2026-05-01"
    (own, _, _), (stored, sidecar, _) = read_samples(path), read_samples(run.sidecar)
    for name in ("force", "time", "position"):
        np.testing.assert_array_equal(getattr(stored, name), getattr(own, name))
    assert sidecar.columns == read_samples(path)[1].columns
    assert run.facts.files[1].name == "a.csv"
    assert run.facts.to_km == pytest.approx(10.2, abs=0.0003)  # one sample of 0.28 m


def test_refused_files_are_listed_until_they_are_corrected(tmp_path: Path) -> None:
    good, copy, damaged, unplaced = (write_run(tmp_path, name, ends_km=(10.0, 10.2)) for name in "abcd")
    damaged.write_text("Zeit [s];km;Kraft [kN]\n", encoding="utf-8")
    write_run(tmp_path, "d", ends_km=(10.0, 10.2), seed=1)
    sidecar = unplaced.with_suffix(".toml").read_text(encoding="utf-8")
    unplaced.with_suffix(".toml").write_text(sidecar.partition("[measurement]")[0], encoding="utf-8")
    copy.write_text(copy.read_text(encoding="utf-8") + "\n", encoding="utf-8")  # other bytes, same force
    runs = tmp_path / "runs"
    assert [item.state for item in collect([good, copy, damaged, unplaced], runs)] == ["imported", *["refused"] * 3]
    reasons = {Path(item.file).name: item.reason for item in list_refused(runs)}
    assert "has the force of the run" in reasons["b.csv"]
    assert "key measurement: missing" in reasons["d.csv"]
    assert "c.csv" in reasons["c.csv"]
    unplaced.with_suffix(".toml").write_text(sidecar, encoding="utf-8")
    assert [item.state for item in collect([unplaced], runs)] == ["imported"]
    assert {Path(item.file).name for item in list_refused(runs)} == {"b.csv", "c.csv"}
    good.with_suffix(".toml").write_text(sidecar.replace('"d.csv"', '"a.csv"').replace("2026-05-01", "2026-05-02"))
    (changed,) = collect([good], runs)
    assert "with another sidecar or source" in changed.remarks[0]


def test_an_interrupted_import_keeps_its_runs_and_is_resumed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second run is interrupted when its table is written, but not its facts; the result equals one import."""
    files = [write_run(tmp_path, f"run{i}", ends_km=(10.0, 10.2), seed=i) for i in range(3)]
    collect(files, tmp_path / "whole")
    examine = run_collection._examine

    def stop(path: Path, digests: object, remarks: object) -> object:
        if next(iter(digests[1:])).name == "run1.csv":  # type: ignore[index]
            raise KeyboardInterrupt
        return examine(path, digests, remarks)  # type: ignore[arg-type]

    monkeypatch.setattr(run_collection, "_examine", stop)
    monkeypatch.setattr(run_collection.shutil, "rmtree", lambda *_, **__: None)  # a killed process removes nothing
    with pytest.raises(KeyboardInterrupt):
        collect(files, tmp_path / "runs")
    monkeypatch.undo()
    assert len(list((tmp_path / "runs").glob(".staged-*"))) == 1
    assert len(list(list_runs(tmp_path / "runs"))) == 1
    assert [item.state for item in collect(files, tmp_path / "runs")] == ["known", "imported", "imported"]
    assert list_bytes(tmp_path / "runs") == list_bytes(tmp_path / "whole")


IMPORT = """
import sys
from pathlib import Path
from pantocheck.conformance.network.run_collection import import_files, open_collection
files, folder = [Path(name) for name in sys.argv[2:]], Path(sys.argv[1])
with open_collection(folder):
    print("begin", flush=True)
    for item in import_files(files, folder, None):
        print(item.state, flush=True)
"""


def test_an_import_killed_at_random_times_loses_and_doubles_nothing(tmp_path: Path) -> None:
    """Killed five times within 0.3 s of its start: each listed run is whole, and the next import adds the others."""
    files = [write_run(tmp_path, f"run{i}", ends_km=(10.0, 10.3), seed=i) for i in range(8)]
    collect(files, tmp_path / "whole")
    random, runs, killed = np.random.default_rng(37), tmp_path / "runs", 0
    for delay in random.uniform(0.0, 0.3, 5):
        command = [sys.executable, "-c", IMPORT, str(runs), *map(str, files)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "begin\n"
            time.sleep(delay)
            process.kill()
        killed += process.returncode != 0
        for run in list_runs(runs):
            assert hash_force(read_samples(run.sidecar)[0])[:16] == run.facts.run
    assert killed
    states = [item.state for item in collect(files, runs)]
    assert set(states) <= {"known", "imported"}
    assert list_bytes(runs) == list_bytes(tmp_path / "whole")


def test_files_without_a_sidecar_share_one_and_suspicions_are_kept(tmp_path: Path) -> None:
    path = write_run(tmp_path, "a", ends_km=(10.0, 10.2))
    shared = path.with_suffix(".toml").rename(tmp_path / "train.toml")
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([*lines[:200], *lines[400:]]) + "\n", encoding="utf-8")
    (item,) = collect([path], tmp_path / "runs", shared)
    assert item.state == "imported"
    assert any("1 gaps, the longest of 0.804 s" in remark for remark in item.remarks)
