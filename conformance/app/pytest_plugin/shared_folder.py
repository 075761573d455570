"""Folder that all processes of a pytest session share; like the plugin, this module imports only pytest."""

import tempfile
from pathlib import Path
from typing import Any

import pytest

FOLDER_KEY = "pantocheck_folder"
"""Key of the shared folder in the input of a worker of pytest-xdist."""

_FOLDER = pytest.StashKey[Path]()


def shared_folder(config: pytest.Config) -> Path:
    """Folder of the session for the results of cases, the same in all workers of pytest-xdist."""
    worker: dict[str, Any] | None = getattr(config, "workerinput", None)
    if worker is not None:
        return Path(worker[FOLDER_KEY])
    if _FOLDER not in config.stash:
        config.stash[_FOLDER] = Path(tempfile.mkdtemp(prefix="pantocheck-"))
    return config.stash[_FOLDER]


def created_folder(config: pytest.Config) -> Path | None:
    """Shared folder if this process created it; None in a worker, and if no plan was collected."""
    return config.stash.get(_FOLDER, None)
