"""Fixture of the adapters in other languages: the one in C++ is compiled once."""

import shutil
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[3] / "examples" / "cpp_catenary" / "adapter.cpp"


@pytest.fixture(scope="session")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The adapter in C++, compiled without a warning."""
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    program = tmp_path_factory.mktemp("cpp") / "adapter"
    options = ["-O1", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["g++", *options, "-o", str(program), str(SOURCE)], check=True)
    return program
