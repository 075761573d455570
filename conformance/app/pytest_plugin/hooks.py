"""pytest plugin: every criterion of a plan is a test; the session ends with a certificate.

Every pytest session imports this module, so it imports only pytest until a plan is named.
"""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from pantocheck.conformance.app.pytest_plugin.shared_folder import FOLDER_KEY, created_folder, shared_folder

if TYPE_CHECKING:
    from pantocheck.conformance.app.pytest_plugin.user_fixtures import GradedCase
    from pantocheck.conformance.app.self_test.fmu_check import FmuCheck

_LINES = pytest.StashKey[list[str]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the plugin."""
    group = parser.getgroup("pantocheck", "conformance of pantograph-catenary simulators (pytest PLAN.toml)")
    group.addoption("--pantocheck-out", metavar="DIR", help="folder of the certificate; replaces that of the plan")
    group.addoption("--pantocheck-formats", metavar="LIST", help="e.g. html,json; replaces the formats of the plan")
    group.addoption(
        "--pantocheck-trust",
        choices=("primary", "secondary", "provisional"),
        help="lowest trust of limits that count; replaces that of the plan",
    )
    group.addoption(
        "--pantocheck-cases",
        action="append",
        default=[],
        metavar="DIR",
        help="folder with further cases, whose ids begin with own/; added to those of the plan",
    )
    group.addoption(
        "--pantocheck-verdicts",
        choices=("criteria", "verification", "both"),
        help="verdicts that decide; replaces those of the plan",
    )
    group.addoption(
        "--pantocheck-no-verdict",
        choices=("fail", "accept"),
        default="fail",
        help="result of a session whose cases have no limit to judge them; default: fail",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a plan that is named as an argument or in `testpaths`."""
    if file_path.suffix != ".toml" or not _is_named(file_path, parent.config):
        return None
    from pantocheck.conformance.app.pytest_plugin.collection import PlanFile

    plan: pytest.Collector = PlanFile.from_parent(parent, path=file_path)
    return plan


def _is_named(path: Path, config: pytest.Config) -> bool:
    # pytest omits an argument inside another argument from its collected paths, so they cannot be used here.
    arguments = (argument.partition("::")[0] for argument in config.args)
    return any((config.invocation_params.dir / argument).resolve() == path.resolve() for argument in arguments)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Send the shared folder to a worker of pytest-xdist."""
    node.workerinput[FOLDER_KEY] = str(shared_folder(node.config))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the certificate of every plan with a finished case, after all workers have finished."""
    config, folder = session.config, created_folder(session.config)
    if folder is not None and any(folder.iterdir()):
        from pantocheck.conformance.app.pytest_plugin.collection import write_certificates
        from pantocheck.conformance.core.input_error import InputError

        try:
            config.stash[_LINES], not_passed = write_certificates(config, folder)
        except InputError as error:
            config.stash[_LINES], not_passed = [f"no certificate: {error}"], True
        if not_passed and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """Print the paths of the certificates."""
    if lines := config.stash.get(_LINES, []):
        terminalreporter.section("pantocheck")
        for line in lines:
            terminalreporter.write_line(line)


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the shared folder if this process created it."""
    if (folder := created_folder(config)) is not None:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session")
def pantocheck_run(pytestconfig: pytest.Config) -> "Callable[..., GradedCase]":
    """Function that runs a case on a system and grades it; see `user_fixtures.run_and_grade`."""
    from functools import partial

    from pantocheck.conformance.app.pytest_plugin.user_fixtures import run_and_grade

    return partial(run_and_grade, **_options(pytestconfig))


@pytest.fixture(scope="session")
def pantocheck_assess(pytestconfig: pytest.Config) -> "Callable[..., GradedCase]":
    """Function that grades a record, or arrays of force, as a run of a case; see `user_fixtures.grade_arrays`."""
    from functools import partial

    from pantocheck.conformance.app.pytest_plugin.user_fixtures import grade_arrays

    return partial(grade_arrays, **_options(pytestconfig))


@pytest.fixture(scope="session")
def pantocheck_pantograph() -> "Callable[..., FmuCheck]":
    """Function that checks an FMU as a pantograph; see `user_fixtures.check_pantograph`."""
    from pantocheck.conformance.app.pytest_plugin.user_fixtures import check_pantograph

    return check_pantograph


def _options(config: pytest.Config) -> dict[str, Any]:
    """Options of the session for the grading of a case."""
    trust = config.getoption("pantocheck_trust") or "secondary"
    folders = tuple(str(config.invocation_params.dir / name) for name in config.getoption("pantocheck_cases"))
    return {"trust": trust, "verdicts": config.getoption("pantocheck_verdicts"), "case_folders": folders}
