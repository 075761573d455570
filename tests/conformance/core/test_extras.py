"""Extras: every optional package is loaded when it is used, and a missing one is named with its installation."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.extras import EXTRA_OF_PACKAGE, NOT_INSTALLED, refuse_missing_package, require_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.verification import verify_document
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.report_files import DEFAULT_FORMATS, FILES
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
FOR_DEVELOPERS = {"test", "docs", "mutation", "peers", "all"}
"""Extras whose packages no command imports; `all` repeats the others."""

WITHOUT_EXTRAS = f"""
import sys
for name in {sorted(EXTRA_OF_PACKAGE)}:
    sys.modules[name] = None  # as if it was not installed
"""

NEEDS_AN_EXTRA = (
    *("conformance.documents.pdf_check", "conformance.documents.pdf_check"),
    *("conformance.core.hdf5_table", "conformance.core.matlab_table"),
    *("conformance.core.uff_table", "conformance.core.parquet_table"),
)
"""Readers and writers that import an optional package on loading."""

CODE_OF_NUMBA = "model.dynamics.vector_code"
"""Vectors in kernels of numba, which loads them before it compiles a function."""


def run_without_extras(code: str, *arguments: str, folder: Path) -> dict[str, Any]:
    """Run code in a process without optional packages and the core in C; it prints one JSON object at its end."""
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_EXTRAS + code, *arguments],
        cwd=folder, env=os.environ | {CORE_VARIABLE: "numba"}, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert "Traceback" not in done.stderr
    return dict(json.loads(done.stdout.splitlines()[-1]))


def list_distributions(extra: str) -> set[str]:
    """Distributions of an extra in the spelling of an import."""
    names = (re.match(r"[\w-]+", requirement) for requirement in PROJECT["optional-dependencies"][extra])
    return {match[0].lower().replace("-", "_") for match in names if match is not None}


def test_packages_and_extras_are_those_of_the_project() -> None:
    """Every distribution of an extra is known by its import, and `all` holds every extra of a user."""
    extras = set(PROJECT["optional-dependencies"]) - FOR_DEVELOPERS
    assert set(EXTRA_OF_PACKAGE.values()) == extras
    for extra in extras:
        known = {package for package, owner in EXTRA_OF_PACKAGE.items() if owner == extra}
        assert list_distributions(extra) <= known
    (everything,) = PROJECT["optional-dependencies"]["all"]
    assert everything == f"pantocheck[{','.join(name for name in PROJECT['optional-dependencies'] if name in extras)}]"


def test_record_is_graded_and_verified_without_extras(tmp_path: Path, wave: type[Wave], case_250: Case) -> None:
    """The core installation writes all default formats but PDF, with a remark; a full one finds the same page.

    Every file but readers and time steps loads: the import rule behind that installation, whose time steps run in C.
    """
    record = wave().run(case_250).record
    write_record(tmp_path / "records" / "r250.csv", record, case=case_250.id)
    code = """
import importlib, json, pathlib
from typer.testing import CliRunner
from pantocheck.conformance.app.commands.command_list import app

def run(*arguments):
    done = CliRunner().invoke(app, arguments)
    return [done.exit_code, done.stdout, done.stderr]

case = "en50318-2002/250"
commands = {
    "run": run("run", case, "--system", "record:records", "--out", "report"),
    "html": run("verify", "report/certificate.html", "--numbers-only"),
    "json": run("verify", "report/results.json", "--numbers-only"),
    "pdf": run("run", case, "--system", "record:records", "--formats", "pdf", "--out", "report"),
    "builtin": run("run", case),
    "hdf5": run("simulate", case, "--out", "a.h5"),
    "statics": run("show", case),
    "compare": run("compare", "report/results.json", "report/results.json", "--out", "comparison"),
}
loaded = sorted(name for name in ("numba", "typst", "pyuff", "h5py", "pypdf") if sys.modules.get(name) is not None)
failed, root = {}, pathlib.Path(sys.argv[1])
for path in sorted(path for top in ("model", "conformance") for path in (root / top).rglob("*.py")):
    name = ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
    try:
        importlib.import_module("pantocheck." + name)
    except ModuleNotFoundError as error:
        failed[name] = str(error.name)
print(json.dumps({"loaded": loaded, "failed": failed, **commands}))
"""
    done = run_without_extras(code, str(ROOT), folder=tmp_path)
    assert set(done["failed"]) == {CODE_OF_NUMBA, *NEEDS_AN_EXTRA}
    assert done["failed"][CODE_OF_NUMBA] in {"numba", "llvmlite"}
    assert done["loaded"] == []
    no_pdf = "remark: no PDF is written, because the package typst is not installed. "
    exit_code, _, errors = done["run"]
    assert (exit_code, errors) == (1, f"{no_pdf}Install it: pip install 'pantocheck[pdf]'\n"), done["run"]
    written = {path.name for path in (tmp_path / "report").iterdir()}
    assert written == {FILES[name] for name in DEFAULT_FORMATS} - {"certificate.pdf"}
    results = read_results(tmp_path / "report" / "results.json")
    assert (results.platform.core, results.renderer.typst) == ("none", NOT_INSTALLED)
    for document in ("html", "json"):
        assert "Proved" in done[document][1]
        assert "Contradict" not in done[document][1]
    for command, extra in (("pdf", "pdf"), ("builtin", "simulator"), ("hdf5", "massdrop")):
        exit_code, _, errors = done[command]
        assert exit_code == 2
        assert errors.endswith(f"Install it: pip install 'pantocheck[{extra}]'\n")
    assert done["statics"][0] == done["compare"][0] == 0
    assert verify_document(tmp_path / "report" / "certificate.html").state == "consistent"


def test_missing_package_is_named_with_the_line_that_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError) as caught, refuse_missing_package("record 'a.h5'"):
        raise ModuleNotFoundError("No module named 'h5py._hl'", name="h5py._hl")
    assert str(caught.value) == (
        "record 'a.h5': needs the package h5py, which is not installed.\n"
        "  Install it: pip install 'pantocheck[massdrop]'"
    )
    # A package that no extra installs is a defect of the installation, not a missing extra.
    with pytest.raises(ModuleNotFoundError, match="llvmlite"), refuse_missing_package("a passage"):
        raise ModuleNotFoundError("No module named 'llvmlite'", name="llvmlite")
    require_package("numba", "reference simulator")
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(InputError, match=r"pip install 'pantocheck\[simulator\]'"):
        require_package("numba", "reference simulator")
