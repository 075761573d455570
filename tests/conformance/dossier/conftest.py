"""Fixtures of the procedure: one system for all tests, so that each case is simulated once."""

from pathlib import Path

import pytest

from helpers.example_dossier import CachedSimulator, copy_example, discretise_once, validate_example
from pantocheck.conformance.results.results_format import Results


@pytest.fixture(autouse=True)
def _keep_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pantocheck.conformance.comparison.static_comparison.discretise", discretise_once)


@pytest.fixture(scope="session")
def system() -> CachedSimulator:
    """Reference simulator that runs each case once."""
    return CachedSimulator()


@pytest.fixture(scope="session")
def results(system: CachedSimulator, tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Results of the complete example."""
    folder: Path = tmp_path_factory.mktemp("example")
    return validate_example(copy_example(folder / "in"), system, folder / "out")
