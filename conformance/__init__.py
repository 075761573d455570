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
    "app.notebook.campaign_session": "read_traces run_campaign",
    "app.notebook.fitted_pantograph": "FittedPantograph fit_pantograph",
    "app.notebook.graded_results": "GradedResults assess_run grade_cases open_results validate_dossier",
    "app.notebook.identified_lines": "FittedDamping IdentifiedLines IdentifiedRecords identify_line open_modes",
    "app.notebook.opened_case": "OpenedCase build_case list_cases open_case",
    "app.notebook.opened_drop": "OpenedDrop open_drop",
    "app.notebook.opened_line": "OpenedLine OpenedPantograph open_line open_pantograph",
    "app.notebook.opened_run": "ComparedRuns OpenedRun SimulatedRun compare_runs open_run",
    "app.notebook.verified_report": "VerifiedReport verify_report",
    "core.input_error": "InputError",
}
"""Public names by their module."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    for module, names in _MODULES.items():
        if name in names.split():
            return getattr(import_module(f"pantocheck.conformance.{module}"), name)
    raise AttributeError(f"module 'pantocheck.conformance' has no attribute {name!r}")
