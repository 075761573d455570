"""Fixture of the tests of commands."""

import logging

import pytest


@pytest.fixture(autouse=True)
def enabled_loggers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Loggers of the suite as in a new process: import-linter disables all that exist when it is imported."""
    for name in logging.root.manager.loggerDict:
        if name.startswith("pantocheck"):
            monkeypatch.setattr(logging.getLogger(name), "disabled", False)
