"""Cache of the compiled kernels: a private folder where nothing else can be written."""

import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from pantocheck.model import kernel_cache


def test_private_folder_is_provided_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Kernels are pickles: a folder that others can write, or whose name they can guess, would run their code."""
    monkeypatch.setattr(kernel_cache, "_is_writable", lambda folder: False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "numba")
    monkeypatch.setenv(kernel_cache.VARIABLE, "")
    monkeypatch.delenv(kernel_cache.VARIABLE)
    assert not kernel_cache.has_kept_kernels()
    kernel_cache.provide_kernel_cache()
    kernel_cache.provide_kernel_cache()
    (folder,) = tmp_path.iterdir()
    assert os.environ[kernel_cache.VARIABLE] == str(folder)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert folder.stat().st_uid == os.getuid()
    assert capsys.readouterr().err.count("kernels are compiled for this run only") == 1
    kernel_cache._remove(str(tmp_path / "gone"), os.getpid())  # no error at the exit if the user removed it


def test_folder_of_the_user_is_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(kernel_cache, "_is_writable", lambda folder: False)
    monkeypatch.setenv(kernel_cache.VARIABLE, str(tmp_path))
    kernel_cache.provide_kernel_cache()
    assert os.environ[kernel_cache.VARIABLE] == str(tmp_path)


@pytest.mark.parametrize("folder", ["dynamics_1f", "numba/dynamics_1f"])
def test_kernels_of_an_earlier_run_are_found(folder: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Only the outermost kernel counts: it is kept after all those that it calls."""
    monkeypatch.setenv(kernel_cache.VARIABLE, str(tmp_path))
    (tmp_path / folder).mkdir(parents=True)
    (tmp_path / folder / "vectors.dot-3.py311.nbi").touch()
    assert not kernel_cache.has_kept_kernels()
    (tmp_path / folder / "recording._advance-9.py311.nbi").touch()
    assert kernel_cache.has_kept_kernels()


def test_kernels_older_than_a_source_are_removed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A kept kernel can name a class that an update of the suite has moved to another file."""
    monkeypatch.setenv(kernel_cache.VARIABLE, str(tmp_path))
    (tmp_path / "dynamics_1f").mkdir()
    old, new = (tmp_path / "dynamics_1f" / f"{name}.py311.nbi" for name in ("vectors.dot-3", "recording._advance-9"))
    old.touch()
    os.utime(old, (0, 0))
    new.touch()
    kernel_cache.drop_outdated_kernels.__wrapped__()
    assert [old.exists(), new.exists()] == [False, True]


@pytest.mark.parametrize(("path", "writable"), [("", True), ("a/b", True), ("program", False), ("program/a", False)])
def test_writable_folder_is_found(path: str, writable: bool, tmp_path: Path) -> None:
    (tmp_path / "program").touch(mode=0o755)
    assert kernel_cache._is_writable(tmp_path / path) is writable


@pytest.mark.skipif(os.getuid() != 0 or shutil.which("setpriv") is None, reason="another user is needed")
def test_kernels_are_loaded_from_a_read_only_installation_without_home() -> None:
    """Another user, who may read everything and write nothing but the folder of temporary files."""
    code = (
        "import os; from pantocheck.model.dynamics.active_window import search\n"
        "search.built.compile('(float64[::1], int64, int64, float64)'); print(os.environ['NUMBA_CACHE_DIR'])"
    )
    user = [
        "setpriv",
        "--reuid=65534",
        "--clear-groups",
        *(f"--{kind}-caps=+dac_read_search" for kind in ("inh", "ambient")),
    ]
    environment = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "PYTHONPATH": os.pathsep.join(sys.path)}
    result = subprocess.run(
        [*user, sys.executable, "-c", code],
        env=environment,
        cwd="/",
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    if "setpriv:" in result.stderr:
        pytest.skip("no capabilities here")
    assert result.returncode == 0, result.stderr
    assert result.stderr.count("kernels are compiled for this run only") == 1
    assert not Path(result.stdout.strip()).exists()  # removed at the exit


def test_second_process_loads_the_kernels_of_the_first(tmp_path: Path) -> None:
    """Also a worker of a pool or of pytest: a fresh process with the same folder compiles nothing."""
    code = """
from pantocheck.model.dynamics.active_window import search
search.built.compile("(float64[::1], int64, int64, float64)")
print(sum(search.stats.cache_misses.values()), sum(search.stats.cache_hits.values()))
"""
    environment = os.environ | {kernel_cache.VARIABLE: str(tmp_path)}
    runs = [
        subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True, timeout=120
        ).stdout.split()
        for _ in range(2)
    ]
    assert runs == [["1", "0"], ["0", "1"]]
