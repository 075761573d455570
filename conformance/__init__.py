"""Open conformance suite for pantograph-catenary simulators: its public interface for scripts and notebooks.

Every public name is loaded on first use, so that a program that reads records does not wait for the simulator.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.interface.campaign_session import run_campaign
    from pantocheck.conformance.interface.fitted_damping import FittedDamping
    from pantocheck.conformance.interface.graded_results import GradedResults, assess_run, grade_cases, open_results
    from pantocheck.conformance.interface.identified_lines import (
        IdentifiedLines,
        IdentifiedRecords,
        identify_line,
        open_modes,
    )
    from pantocheck.conformance.interface.opened_case import OpenedCase, list_cases, open_case
    from pantocheck.conformance.interface.opened_drop import OpenedDrop, open_drop
    from pantocheck.conformance.interface.opened_line import OpenedLine
    from pantocheck.conformance.interface.opened_run import OpenedRun, SimulatedRun, open_run

__all__ = [
    "FittedDamping",
    "GradedResults",
    "IdentifiedLines",
    "IdentifiedRecords",
    "InputError",
    "OpenedCase",
    "OpenedDrop",
    "OpenedLine",
    "OpenedRun",
    "SimulatedRun",
    "assess_run",
    "grade_cases",
    "identify_line",
    "list_cases",
    "open_case",
    "open_drop",
    "open_modes",
    "open_results",
    "open_run",
    "run_campaign",
]

_MODULES = {
    "FittedDamping": "interface.fitted_damping",
    "GradedResults": "interface.graded_results",
    "IdentifiedLines": "interface.identified_lines",
    "IdentifiedRecords": "interface.identified_lines",
    "InputError": "input_files.input_error",
    "OpenedCase": "interface.opened_case",
    "OpenedDrop": "interface.opened_drop",
    "OpenedLine": "interface.opened_line",
    "OpenedRun": "interface.opened_run",
    "SimulatedRun": "interface.opened_run",
    "assess_run": "interface.graded_results",
    "grade_cases": "interface.graded_results",
    "identify_line": "interface.identified_lines",
    "list_cases": "interface.opened_case",
    "open_case": "interface.opened_case",
    "open_drop": "interface.opened_drop",
    "open_modes": "interface.identified_lines",
    "open_results": "interface.graded_results",
    "open_run": "interface.opened_run",
    "run_campaign": "interface.campaign_session",
}
"""Modules of the public names."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name not in _MODULES:
        raise AttributeError(f"module 'pantocheck.conformance' has no attribute {name!r}")
    return getattr(import_module(f"pantocheck.conformance.{_MODULES[name]}"), name)
