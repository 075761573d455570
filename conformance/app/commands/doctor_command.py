"""`pantocheck doctor`: versions, extras, core of the simulator, threads, fonts and folders."""

import os
import platform
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from itertools import groupby
from typing import Literal

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text
from pantocheck.conformance.cases.case_source import list_case_packages
from pantocheck.conformance.core.processes import THREAD_VARIABLES, count_processors, list_user_variables
from pantocheck.conformance.core.suite_identity import find_suite_commit, suite_digest
from pantocheck.model.dynamics.core_choice import core_name, find_core_in_c
from pantocheck.model.kernel_cache import find_kernel_cache

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
"""Names of the browsers that the tests of the pages can use."""


@dataclass(frozen=True)
class DeclaredPackage:
    """A declared dependency."""

    name: str
    """Name of the distribution."""
    lowest: str
    """Lowest declared version."""
    extra: str
    """Name of the extra; empty for a dependency of every installation."""

    @property
    def installed(self) -> str | None:
        """Installed version; None if it is not installed."""
        try:
            return version(self.name)
        except PackageNotFoundError:
            return None

    @property
    def state(self) -> Literal["installed", "too old", "missing"]:
        """Whether the dependency is usable."""
        if self.installed is None:
            return "missing"
        return "installed" if _parse_version(self.installed) >= _parse_version(self.lowest) else "too old"


def list_requirements() -> tuple[DeclaredPackage, ...]:
    """Declared dependencies of the installed suite, those of every installation first."""
    pattern = re.compile(r"""([\w.-]+)\s*>=\s*([\w.]+)[^;]*(?:;.*extra\s*==\s*['"]([\w-]+)['"])?""")
    found = (pattern.match(text) for text in requires("pantocheck") or ())
    requirements = (DeclaredPackage(match[1], match[2], match[3] or "") for match in found if match is not None)
    return tuple(sorted(requirements, key=lambda requirement: requirement.extra))


def list_facts(environment: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Facts on the environment by name, in the order of the report."""
    yield "Pantocheck", version("pantocheck")
    yield "digest of the suite", suite_digest() or "not known"
    yield "commit of the suite", find_suite_commit() or "not known"
    yield "Python", f"{platform.python_version()} ({platform.python_implementation()}), {sys.executable}"
    yield "system", f"{platform.system()} {platform.release()}, {platform.machine()}"
    yield "processors", f"{count_processors()} usable of {os.cpu_count()}"
    yield (
        "thread limits",
        ", ".join(f"{name}={environment[name]}" for name in _THREADS if name in environment) or "none",
    )
    in_c = find_core_in_c()
    yield "core of the simulator", core_name() + (f"; not in C: {in_c}" if isinstance(in_c, str) else "")
    yield "kernels of numba", str(find_kernel_cache() or "in a folder of each run: set NUMBA_CACHE_DIR to keep them")
    folder = tempfile.gettempdir()
    yield "temporary folder", f"{folder}, {shutil.disk_usage(folder).free / 1e9:.1f} GB free"
    yield "text encoding", f"{sys.stdout.encoding}, files {sys.getfilesystemencoding()}"
    yield "browser for tests", next(filter(None, map(shutil.which, BROWSERS)), "none: tests of the pages are skipped")
    yield from ((package.text, package.value) for package in list_case_packages())
    yield "fonts", "those of matplotlib and Typst; fonts of the machine are not used"


_THREADS = ("NUMBA_NUM_THREADS", *THREAD_VARIABLES)


def _parse_version(text: str) -> tuple[int, ...]:
    """Leading numbers of a version: `2.10.0rc1` gives (2, 10, 0)."""
    match = re.match(r"\d+(?:\.\d+)*", text)
    return tuple(map(int, match[0].split("."))) if match else ()


def doctor_command() -> CommandOutput:
    """Show versions, extras, caches and folders.

    Exit code 0: every dependency is installed in a sufficient version. Exit code 1: one is missing or too old. Packages
    of an extra may be missing.

    Example: pantocheck doctor --json > environment.json
    """
    facts, requirements = dict(list_facts(list_user_variables())), list_requirements()
    faulty = [requirement for requirement in requirements if not requirement.extra and requirement.state != "installed"]
    names = ("name", "extra", "lowest", "installed", "state")
    packages = [{name: getattr(requirement, name) for name in names} for requirement in requirements]
    listed = ", ".join(requirement.name for requirement in faulty)
    conclusion = Text(f"Missing or too old: {listed}" if faulty else "Every dependency is installed.")
    return CommandOutput(
        conclusion,
        {"environment": facts, "packages": packages},
        [*_build_tables(facts, requirements)],
        exit_code=1 if faulty else 0,
    )


def _build_tables(facts: dict[str, str], requirements: tuple[DeclaredPackage, ...]) -> Iterator[RenderableType]:
    rows = ((name, escape_text(value)) for name, value in facts.items())
    yield build_table("fact", "value", unbroken=("fact",), rows=rows)
    for extra, group in groupby(requirements, lambda requirement: requirement.extra):
        members = list(group)
        complete = all(member.state == "installed" for member in members)
        state = "complete" if complete else f"not complete; pip install 'pantocheck[{extra}]'"
        title = f"extra {extra}: {state}" if extra else "packages of every installation"
        yield Padding(escape_text(title), (1, 0, 0, 0))
        packages = ((member.name, member.installed or "-", member.lowest, member.state) for member in members)
        yield build_table("package", "installed", "lowest", "state", rows=packages)
