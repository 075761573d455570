"""Open conformance suite for pantograph-catenary simulators: its public interface for scripts and notebooks.

Every public name is loaded on first use, so that a program that reads records does not wait for the simulator.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.interface.built_case import build_case
    from pantocheck.conformance.interface.campaign_session import read_traces, run_campaign
    from pantocheck.conformance.interface.compared_runs import ComparedRuns, compare_runs
    from pantocheck.conformance.interface.fitted_damping import FittedDamping
    from pantocheck.conformance.interface.fitted_pantograph import FittedPantograph, fit_pantograph
    from pantocheck.conformance.interface.graded_results import (
        GradedResults,
        assess_run,
        grade_cases,
        open_results,
        validate_dossier,
    )
    from pantocheck.conformance.interface.identified_lines import (
        IdentifiedLines,
        IdentifiedRecords,
        identify_line,
        open_modes,
    )
    from pantocheck.conformance.interface.opened_case import OpenedCase, list_cases, open_case
    from pantocheck.conformance.interface.opened_drop import OpenedDrop, open_drop
    from pantocheck.conformance.interface.opened_line import OpenedLine, open_line
    from pantocheck.conformance.interface.opened_pantograph import OpenedPantograph, open_pantograph
    from pantocheck.conformance.interface.opened_run import OpenedRun, SimulatedRun, open_run
    from pantocheck.conformance.interface.verified_report import VerifiedReport, verify_report

__all__ = [
    "ComparedRuns",
    "FittedDamping",
    "FittedPantograph",
    "GradedResults",
    "IdentifiedLines",
    "IdentifiedRecords",
    "InputError",
    "OpenedCase",
    "OpenedDrop",
    "OpenedLine",
    "OpenedPantograph",
    "OpenedRun",
    "SimulatedRun",
    "VerifiedReport",
    "assess_run",
    "build_case",
    "compare_runs",
    "fit_pantograph",
    "grade_cases",
    "identify_line",
    "list_cases",
    "open_case",
    "open_drop",
    "open_line",
    "open_modes",
    "open_pantograph",
    "open_results",
    "open_run",
    "read_traces",
    "run_campaign",
    "validate_dossier",
    "verify_report",
]

_MODULES = {
    "ComparedRuns": "interface.compared_runs",
    "FittedDamping": "interface.fitted_damping",
    "FittedPantograph": "interface.fitted_pantograph",
    "GradedResults": "interface.graded_results",
    "IdentifiedLines": "interface.identified_lines",
    "IdentifiedRecords": "interface.identified_lines",
    "InputError": "input_files.input_error",
    "OpenedCase": "interface.opened_case",
    "OpenedDrop": "interface.opened_drop",
    "OpenedLine": "interface.opened_line",
    "OpenedPantograph": "interface.opened_pantograph",
    "OpenedRun": "interface.opened_run",
    "SimulatedRun": "interface.opened_run",
    "VerifiedReport": "interface.verified_report",
    "assess_run": "interface.graded_results",
    "build_case": "interface.built_case",
    "compare_runs": "interface.compared_runs",
    "fit_pantograph": "interface.fitted_pantograph",
    "grade_cases": "interface.graded_results",
    "identify_line": "interface.identified_lines",
    "list_cases": "interface.opened_case",
    "open_case": "interface.opened_case",
    "open_drop": "interface.opened_drop",
    "open_line": "interface.opened_line",
    "open_modes": "interface.identified_lines",
    "open_pantograph": "interface.opened_pantograph",
    "open_results": "interface.graded_results",
    "open_run": "interface.opened_run",
    "read_traces": "interface.campaign_session",
    "run_campaign": "interface.campaign_session",
    "validate_dossier": "interface.graded_results",
    "verify_report": "interface.verified_report",
}
"""Modules of the public names."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name not in _MODULES:
        raise AttributeError(f"module 'pantocheck.conformance' has no attribute {name!r}")
    return getattr(import_module(f"pantocheck.conformance.{_MODULES[name]}"), name)
