"""Module by which pytest finds the plugin `pantocheck.conformance.app.pytest_plugin.hooks`.

pytest prepares the top-level modules of the distribution of a plugin for its assertions. Without such a module it takes
the files below `pantocheck/` for top-level modules, and warns that `__main__` is already imported.
"""

from pantocheck.conformance.app.pytest_plugin.hooks import (
    pantocheck_assess,
    pantocheck_pantograph,
    pantocheck_run,
    pytest_addoption,
    pytest_collect_file,
    pytest_configure_node,
    pytest_sessionfinish,
    pytest_terminal_summary,
    pytest_unconfigure,
)

__all__ = [
    "pantocheck_assess",
    "pantocheck_pantograph",
    "pantocheck_run",
    "pytest_addoption",
    "pytest_collect_file",
    "pytest_configure_node",
    "pytest_sessionfinish",
    "pytest_terminal_summary",
    "pytest_unconfigure",
]
