"""`pantocheck doctor`: packages that are missing or too old, and facts on the environment."""

import json
from importlib.metadata import PackageNotFoundError

import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands import doctor_command
from pantocheck.conformance.app.commands.doctor_command import DeclaredPackage, list_requirements


def provide_versions(monkeypatch: pytest.MonkeyPatch, **installed: str) -> None:
    """Let the named packages be the only ones that are installed."""

    def version(name: str) -> str:
        if name in installed:
            return installed[name]
        raise PackageNotFoundError(name)

    monkeypatch.setattr(doctor_command, "version", version)


def test_versions_are_compared_as_numbers_with_those_of_the_distribution(monkeypatch: pytest.MonkeyPatch) -> None:
    for installed in ("2.10.0", "2.9", "2.9.0rc1", "2.8.9", "10"):
        provide_versions(monkeypatch, example=installed)
        assert DeclaredPackage("example", "2.9", "").state == ("too old" if installed == "2.8.9" else "installed")
    declared = ["numpy>=2.0", 'nptdms>=1.9; extra == "tdms"', "dask-jobqueue>=0.9,<2; extra == 'cluster'"]
    monkeypatch.setattr(doctor_command, "requires", lambda name: declared)
    assert list_requirements() == (
        DeclaredPackage("numpy", "2.0", ""),
        DeclaredPackage("dask-jobqueue", "0.9", "cluster"),
        DeclaredPackage("nptdms", "1.9", "tdms"),
    )


def test_a_missing_package_of_an_extra_is_named_with_its_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_command, "requires", lambda name: ["numpy>=2.0", 'nptdms>=1.9; extra == "tdms"'])
    provide_versions(monkeypatch, numpy="2.4", pantocheck="0.1.0")
    monkeypatch.setenv("COLUMNS", "80")
    done = pantocheck("doctor")
    assert done.exit_code == 0, done.output
    assert "extra tdms: not complete; pip install 'pantocheck[tdms]'" in done.output
    assert max(map(len, done.output.splitlines())) <= 80


def test_a_package_that_is_too_old_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_command, "requires", lambda name: ["numpy>=2.0"])
    provide_versions(monkeypatch, numpy="1.26", pantocheck="0.1.0")
    done = pantocheck("doctor", "--json")
    assert done.exit_code == 1
    report = json.loads(done.output)["result"]
    numpy = {"name": "numpy", "extra": "", "lowest": "2.0", "installed": "1.26", "state": "too old"}
    assert report["packages"] == [numpy]
    assert {"Python", "processors", "core of the simulator", "digest of the suite"} <= report["environment"].keys()
