"""Fixtures for all tests: the case at 250 km/h, its copies, its version with two pantographs, and the known system."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record

EditedCase = Callable[[str, dict[str, Any]], Path]
"""Function that copies the case at 250 km/h with values changed in one of its files; gives the path of the case."""


@pytest.fixture(scope="session")
def wave() -> type[Wave]:
    return Wave


@pytest.fixture(scope="session")
def case_250() -> Case:
    return load_case(library_folder() / "en50318-2002" / "250.toml")


@pytest.fixture
def cases() -> list[Case]:
    return select_cases(["en50318-2002/*"])


@pytest.fixture
def edited_case(tmp_path: Path) -> EditedCase:
    """Copy of the 250 km/h case with values changed in one of its files; gives the path of the case."""

    def copy(file: str, changes: dict[str, Any]) -> Path:
        for name in ("250.toml", "line.toml", "pantograph.toml"):
            shutil.copy(library_folder() / "en50318-2002" / name, tmp_path / name)
        edit_toml(tmp_path / file, changes)
        return tmp_path / "250.toml"

    return copy


@pytest.fixture
def two_pantograph_case(case_250: Case) -> Case:
    """The 250 km/h case with a second pantograph 150 m behind the first."""
    file = case_250.file.model_copy(update={"spacing_m": (150.0,), "pantograph": case_250.file.pantograph * 2})
    return replace(case_250, file=file, pantographs=case_250.pantographs * 2)


@pytest.fixture
def record(two_pantograph_case: Case) -> Record:
    """Run of the case with two pantographs."""
    return Wave().record(two_pantograph_case)
