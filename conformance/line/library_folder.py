"""Folder of the reference cases."""

from importlib.resources import files
from pathlib import Path


def library_folder() -> Path:
    """Folder of the reference cases of the suite."""
    return Path(str(files("pantocheck.reference_cases")))
