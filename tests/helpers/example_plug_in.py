"""The example package of docs/extending.md as an installed distribution."""

import shutil
import tomllib
from pathlib import Path

from helpers.fake_distribution import write_distribution

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin"


def install_example(site: Path) -> None:
    """Copy the package into a folder of installed packages, with its metadata."""
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text("utf-8"))["project"]
    shutil.copytree(EXAMPLE / "acme_lines", site / "acme_lines", ignore=shutil.ignore_patterns("__pycache__"))
    write_distribution(site, project["name"], project["version"], project["entry-points"], {})
