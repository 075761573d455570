"""Open conformance suite for pantograph-catenary simulators: its public interface for scripts and notebooks.

Every public name is loaded on first use, so that a program that reads records does not wait for the simulator.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pantocheck.conformance.app.notebook.campaign_session import read_traces, run_campaign
    from pantocheck.conformance.app.notebook.fitted_pantograph import FittedPantograph, fit_pantograph
    from pantocheck.conformance.app.notebook.graded_results import (
        GradedResults,
        assess_run,
        grade_cases,
        open_results,
        validate_dossier,
    )
    from pantocheck.conformance.app.notebook.identified_lines import (
        FittedDamping,
        IdentifiedLines,
        IdentifiedRecords,
        identify_line,
        open_modes,
    )
    from pantocheck.conformance.app.notebook.opened_case import OpenedCase, build_case, list_cases, open_case
    from pantocheck.conformance.app.notebook.opened_drop import OpenedDrop, open_drop
    from pantocheck.conformance.app.notebook.opened_line import OpenedLine, OpenedPantograph, open_line, open_pantograph
    from pantocheck.conformance.app.notebook.opened_run import (
        ComparedRuns,
        OpenedRun,
        SimulatedRun,
        compare_runs,
        open_run,
    )
    from pantocheck.conformance.app.notebook.verified_report import VerifiedReport, verify_report
    from pantocheck.conformance.core.input_error import InputError

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
    "ComparedRuns": "app.notebook.opened_run",
    "FittedDamping": "app.notebook.identified_lines",
    "FittedPantograph": "app.notebook.fitted_pantograph",
    "GradedResults": "app.notebook.graded_results",
    "IdentifiedLines": "app.notebook.identified_lines",
    "IdentifiedRecords": "app.notebook.identified_lines",
    "InputError": "core.input_error",
    "OpenedCase": "app.notebook.opened_case",
    "OpenedDrop": "app.notebook.opened_drop",
    "OpenedLine": "app.notebook.opened_line",
    "OpenedPantograph": "app.notebook.opened_line",
    "OpenedRun": "app.notebook.opened_run",
    "SimulatedRun": "app.notebook.opened_run",
    "VerifiedReport": "app.notebook.verified_report",
    "assess_run": "app.notebook.graded_results",
    "build_case": "app.notebook.opened_case",
    "compare_runs": "app.notebook.opened_run",
    "fit_pantograph": "app.notebook.fitted_pantograph",
    "grade_cases": "app.notebook.graded_results",
    "identify_line": "app.notebook.identified_lines",
    "list_cases": "app.notebook.opened_case",
    "open_case": "app.notebook.opened_case",
    "open_drop": "app.notebook.opened_drop",
    "open_line": "app.notebook.opened_line",
    "open_modes": "app.notebook.identified_lines",
    "open_pantograph": "app.notebook.opened_line",
    "open_results": "app.notebook.graded_results",
    "open_run": "app.notebook.opened_run",
    "read_traces": "app.notebook.campaign_session",
    "run_campaign": "app.notebook.campaign_session",
    "validate_dossier": "app.notebook.graded_results",
    "verify_report": "app.notebook.verified_report",
}
"""Modules of the public names."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name not in _MODULES:
        raise AttributeError(f"module 'pantocheck.conformance' has no attribute {name!r}")
    return getattr(import_module(f"pantocheck.conformance.{_MODULES[name]}"), name)
