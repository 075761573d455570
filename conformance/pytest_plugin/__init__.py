"""pytest plugin: every criterion of a plan is a test, and a certificate is written at the end of the session.

This module is imported by every pytest of an environment, so it imports nothing but pytest until it is asked for.
"""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pantocheck.conformance.pytest_plugin.user_fixtures import GradedCase

FOLDER = "pantocheck_folder"
"""Key under which a worker of pytest-xdist is told the folder that all of them share."""

_FOLDER = pytest.StashKey[str]()
_LINES = pytest.StashKey[list[str]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of the plugin."""
    group = parser.getgroup("pantocheck", "conformance of pantograph-catenary simulators (pytest PLAN.toml)")
    group.addoption("--pantocheck-out", metavar="DIR", help="folder of the certificate, in place of the plan's")
    group.addoption("--pantocheck-formats", metavar="LIST", help="e.g. html,json, in place of the plan's")
    group.addoption(
        "--pantocheck-trust",
        choices=("primary", "secondary", "provisional"),
        help="lowest trust of limits that count, in place of the plan's",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """A plan is collected if it is named: as an argument, or in `testpaths`."""
    if file_path.suffix != ".toml" or not _named(file_path, parent.config):
        return None
    from pantocheck.conformance.pytest_plugin.collection import PlanFile

    plan: pytest.Collector = PlanFile.from_parent(parent, path=file_path)
    return plan


def _named(path: Path, config: pytest.Config) -> bool:
    # pytest drops an argument that lies inside another one, so what it will look at is no help.
    arguments = (argument.partition("::")[0] for argument in config.args)
    return any((config.invocation_params.dir / argument).resolve() == path.resolve() for argument in arguments)


def shared_folder(config: pytest.Config) -> Path:
    """Folder of this session for results of cases, the same in all workers of pytest-xdist."""
    worker: dict[str, Any] | None = getattr(config, "workerinput", None)
    if worker is not None:
        return Path(worker[FOLDER])
    if _FOLDER not in config.stash:
        config.stash[_FOLDER] = tempfile.mkdtemp(prefix="pantocheck-")
    return Path(config.stash[_FOLDER])


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell a worker of pytest-xdist the shared folder."""
    node.workerinput[FOLDER] = str(shared_folder(node.config))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the certificate of every plan that was run, once all workers are done."""
    config = session.config
    if hasattr(config, "workerinput") or _FOLDER not in config.stash:
        return
    folder = shared_folder(config)
    if any(folder.iterdir()):
        from pantocheck.conformance.input_files.input_error import InputError
        from pantocheck.conformance.pytest_plugin.collection import write_certificates

        try:
            config.stash[_LINES], drifted = write_certificates(config, folder)
        except InputError as error:
            config.stash[_LINES], drifted = [f"no certificate: {error}"], True
        if drifted and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """Say where the certificates are."""
    if lines := config.stash.get(_LINES, []):
        terminalreporter.section("pantocheck")
        for line in lines:
            terminalreporter.write_line(line)


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the shared folder."""
    if _FOLDER in config.stash:
        shutil.rmtree(config.stash[_FOLDER], ignore_errors=True)


@pytest.fixture(scope="session")
def pantocheck_run(pytestconfig: pytest.Config) -> "Callable[..., GradedCase]":
    """Function that runs a case on a system and grades it; see `pytest_grading.run`."""
    from functools import partial

    from pantocheck.conformance.pytest_plugin.user_fixtures import run_and_grade

    return partial(run_and_grade, trust=pytestconfig.getoption("pantocheck_trust") or "secondary")


@pytest.fixture(scope="session")
def pantocheck_assess(pytestconfig: pytest.Config) -> "Callable[..., GradedCase]":
    """Function that grades a record, or arrays of force, as a run of a case; see `pytest_grading.assess`."""
    from functools import partial

    from pantocheck.conformance.pytest_plugin.user_fixtures import grade_arrays

    return partial(grade_arrays, trust=pytestconfig.getoption("pantocheck_trust") or "secondary")
