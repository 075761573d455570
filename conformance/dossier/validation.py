"""Validation of a simulator by a dossier: the steps in the order of the EN 50318 procedure."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.core.decision import parse_decision
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.processes import interruption_exit_code
from pantocheck.conformance.dossier.dossier_file import LineEntry, PantographEntry
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.line_test_step import LineTests, build_line_test_profile, join_pairs
from pantocheck.conformance.dossier.model_steps import (
    check_pantographs,
    check_parameters,
    check_statics,
    list_claims,
    run_reference_models,
)
from pantocheck.conformance.dossier.run_reading import read_run
from pantocheck.conformance.dossier.step_result import StepInterrupted, StepResult
from pantocheck.conformance.execution.runner import Progress, RunInterrupted, identify_system
from pantocheck.conformance.grading.case_selection import choose_verdicts
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.results.procedure_format import STEP_NAMES, Procedure, StepName
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.runs.system import System

INTERRUPTED = "the run was interrupted before this step was finished"
"""Reason of a step that the user ended."""


@dataclass
class Validation:
    """Validation of a system by a dossier; finished steps are kept while it runs."""

    dossier: Dossier
    """Dossier with its files."""
    system: System
    """System under test."""
    folder: Path
    """Folder of the results."""
    jobs: int = 1
    """Number of reference models that run in parallel."""
    progress: Progress | None = None
    """Callback for each finished case or pair."""
    finished: dict[StepName, StepResult] = field(default_factory=dict)

    def run(self) -> Results:
        """Carry out all steps.

        Returns:
            Results with the procedure.

        Raises:
            RunInterrupted: Ctrl-C, SIGTERM or SIGHUP ended the run; the exception holds the results of the finished
                part.
        """
        started = utc_now()
        try:
            for name, carry_out in self._list_steps():
                self.finished[name] = carry_out()
        except StepInterrupted as interruption:
            self.finished[interruption.result.step] = interruption.result
            raise RunInterrupted(self._combine(started), interruption.exit_code) from None
        except KeyboardInterrupt as interruption:
            raise RunInterrupted(self._combine(started), interruption_exit_code(interruption)) from None
        return self._combine(started)

    def _list_steps(self) -> Iterator[tuple[StepName, Callable[[], StepResult]]]:
        """Steps in the order in which they are carried out: the parameters are those of the runs."""
        dossier = self.dossier
        tests = LineTests(dossier, self.system, self.folder)
        yield "pantograph_model", lambda: check_pantographs(dossier)
        yield "static_check", lambda: check_statics(dossier)
        yield (
            "reference_models",
            lambda: run_reference_models(dossier, self.system, self.participation, self.jobs, self.progress),
        )
        yield "line_test", lambda: tests.run(self.progress)
        yield "simulation_parameters", lambda: check_parameters(dossier, self._list_runs())
        yield "limits_of_validity", lambda: list_claims(dossier)

    @property
    def participation(self) -> Participation:
        """Verdicts that decide, accepted records, and the cases of steps that are not required."""
        file = self.dossier.file
        for_information = [step for step in STEP_NAMES if step not in file.required]
        cases = (case for name in for_information if name in self.finished for case in self.finished[name].cases)
        return Participation(
            information=tuple(case.id for case in cases),
            accepted_unconfirmed=file.accept_unconfirmed,
            requested=choose_verdicts(file.reference.verdicts, file.system),
            decision=parse_decision(file.decision),
        )

    def _list_runs(self) -> list[CaseResult]:
        """Results of the cases and pairs with a run of a train."""
        cases = chain.from_iterable(self.finished[name].cases for name in ("reference_models", "line_test"))
        return [case for case in cases if case.run.speed_km_h is not None and case.quantities]

    def _combine(self, started: str) -> Results:
        steps = [self.finished.get(name, StepResult(name, "not done", INTERRUPTED)) for name in STEP_NAMES]
        file = self.dossier.file
        procedure = Procedure(
            title=file.title,
            digest=self.dossier.digest,
            note=file.note,
            steps=[step.describe(step.step in file.required) for step in steps],
            responses=[item for step in steps for item in step.responses],
            statics=[item for step in steps for item in step.statics],
            parameters=[item for step in steps for item in step.parameters],
            joined=join_pairs([case for step in steps if step.step == "line_test" for case in step.cases]),
            evidence=[item for step in steps for item in step.evidence],
            claims=[item for step in steps for item in step.claims],
        )
        identity = identify_system(self.system)
        cases = [case for step in steps for case in step.cases]
        return build_results(cases, identity, file.trust, started, self.participation, procedure)


# Check of the measured and simulated tables of a dossier: each is read as its step reads it, without a simulation.
def check_documents(dossier: Dossier) -> int:
    """Read every table of a dossier; returns their number.

    Raises:
        InputError: A table cannot be read as its kind; the error lists the problems of all tables.
    """
    problems: list[InputError] = []
    profile, tables = build_line_test_profile(dossier.file.line_test), [*dossier.list_tables()]
    for key, name, entry in tables:
        try:
            if isinstance(entry, PantographEntry):
                read_response(dossier.locate(name))
            elif isinstance(entry, LineEntry):
                read_static_record(dossier.locate(name), dossier.lines[entry.name].geometry)
            else:
                read_run(entry, dossier, profile)
        except InputError as error:
            problems += (
                InputError(f"dossier, key {key}: {each.where}", each.found, each.hint) for each in error.problems
            )
    if problems:
        raise join_errors(problems)
    return len(tables)
