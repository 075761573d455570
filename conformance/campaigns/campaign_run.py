"""One run of a campaign, from its inputs to its row in the store. A failure is a row with its reason."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, Protocol, cast

from pantocheck.conformance.campaigns.campaign_design import Inputs, PlannedRun
from pantocheck.conformance.campaigns.run_traces import StoredTraces, pack_traces
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.cases.library import load_case, overlay_limits, source_text
from pantocheck.conformance.cases.limits import Limit, LimitOverride, repeat_limits
from pantocheck.conformance.cases.profile_file import BoundMissing, Profile, resolve_bounds
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict, worst_verdict
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.derived_facts import find_uplift_forces
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.system import System
from pantocheck.conformance.runs.system_choice import choose_system
from pantocheck.conformance.runs.uplift_tuning import START_SLOPE


# Limits of a run from the rules of a profile, at the speed of the run.
@dataclass(frozen=True)
class ProfileLimits:
    """Rules of a profile with the values of the line that they need."""

    profile: Profile
    """Profile without rules that compare with a measured record."""
    uplift_space_mm: float | None
    """Space for the uplift of the contact wire at the supports [mm]."""

    def resolve(self, case: Case) -> tuple[tuple[Limit, ...], tuple[str, ...]]:
        """Limits of a case, and the reason of each rule that has no bound for it.

        Raises:
            InputError: The rules do not apply to the case.
        """
        where = f"profile '{self.profile.name}'"
        if self.profile.compares:
            raise InputError(where, "needs a measured record; a campaign has none", "Choose another profile.")
        if case.file.speed_km_h is None:
            raise InputError(where, f"needs a train, but {case.id} is a static case", "Choose cases with a speed.")
        if self.profile.filter != case.file.filter:
            raise InputError(where, f"has another filter than {case.id}", "Set the filter of the cases with `set`.")
        limits, missing = [], []
        for rule in self.profile.rule:
            try:
                values = {"uplift_space_mm": self.uplift_space_mm}
                lower, upper = resolve_bounds(rule, case.file.speed_km_h, values, None)
            except BoundMissing as reason:
                missing.append(f"{rule.quantity}: {reason}")
                continue
            stated = {"quantity": rule.quantity, "lower": lower, "upper": upper, "trust": rule.trust, "note": rule.note}
            limits.append(Limit.model_validate({**stated, "source": source_text(rule.source)}))
        return repeat_limits(limits, len(case.pantographs)), tuple(missing)


class StartForces(Protocol):
    """Start of the tuning of the uplift forces."""

    def predict(self, case_id: str, inputs: Inputs) -> tuple[float, ...]:
        """Uplift forces for the inputs of a run [N]; empty: those of its case."""


FAILED: Verdict = "error"
"""Verdict of a run without a result."""

LINE_KEYS = {"line", "discretisation"}
"""First parts of the keys that change the line or its mesh."""

CAMPAIGN = "campaign"
"""Origin of the varied inputs in messages."""


@dataclass(frozen=True)
class RunRow:
    """Row of a run in the store."""

    run: PlannedRun
    """The run with its inputs."""
    verdicts: dict[str, Verdict | None]
    """Verdict, and the verdicts by the criteria and by verification; None: not judged."""
    reason: str | None
    """Reason of a run without a result."""
    quantities: dict[str, float]
    """Values by the name of their column, such as `1.mean_force_N`."""
    wall_s: float
    """Computing time [s]."""
    uncertainties: dict[str, float] = field(default_factory=dict)
    """Half-widths of the 95 % intervals of the quantities that have one."""
    traces: bytes = b""
    """Compressed curves; empty if they are not stored."""
    balance_forces: tuple[float, ...] = ()
    """Uplift force of every pantograph for its required mean contact force [N]; empty: no such run."""

    @property
    def is_failed(self) -> bool:
        """Whether the run has no result."""
        return self.verdicts["verdict"] == FAILED


@dataclass(frozen=True)
class RunExecution:
    """Function that executes runs: it is sent to the workers once, and called with each run."""

    case_files: dict[str, str]
    """Files of the base cases by id."""
    changes: tuple[InputChange, ...]
    """Changes of all runs."""
    limits: tuple[LimitOverride, ...]
    """Limits of the user."""
    profile: ProfileLimits | None
    """Rules that are limits of every run; limits of the user replace them."""
    trust: Trust
    """Lowest trust of the limits that count."""
    refined: bool
    """Whether the reference simulator also runs on two other meshes."""
    timeout_s: float
    """Time limit of a program for a case [s]."""
    stored_traces: StoredTraces
    """Runs whose curves are stored, as in `StoredTraces`."""
    start: StartForces | None = None
    """Start of the tuning of each run; None: that of its case."""

    def __call__(self, run: PlannedRun) -> RunRow:
        """Execute a run."""
        start = time.perf_counter()
        try:
            case = self.read_case(run)
            result = run_case(case, self._start_system(run), self.trust)
        except InputError as error:
            return build_failed_row(run, str(error), time.perf_counter() - start)
        missing = () if self.profile is None else self.profile.resolve(case)[1]
        row = _build_row(run, result, missing, time.perf_counter() - start)
        traces = pack_traces(result, row.verdicts["verdict"], self.stored_traces)
        return replace(row, traces=traces, balance_forces=_find_balance_forces(case, result))

    def find_line(self, run: PlannedRun) -> tuple[object, ...] | None:
        """Case of a run, and its inputs that change the line or its mesh; None: its passages are not simulated here."""
        if run.system != "builtin":
            return None
        return (run.case_id, *((key, value) for key, value in run.inputs.items() if key.split(".")[0] in LINE_KEYS))

    def _start_system(self, run: PlannedRun) -> System:
        """System of a run; the simulator begins the tuning at predicted uplift forces, if there are any."""
        system = _choose_system(run.system, self.refined, self.timeout_s)
        if self.start is None or self.refined or run.system != "builtin":
            return system
        started: System = replace(cast(Any, system), start_forces=self.start.predict(run.case_id, run.inputs))
        return started

    def read_case(self, run: PlannedRun) -> Case:
        """Case of a run, with its inputs and the limits of the user."""
        case = load_case(Path(self.case_files[run.case_id]), (*self.changes, *build_input_changes(run.inputs)))
        rules = () if self.profile is None else self.profile.resolve(case)[0]
        (limited,) = overlay_limits([case.with_limits(rules)], self.limits)
        return limited


def build_input_changes(inputs: Inputs) -> tuple[InputChange, ...]:
    """Changes of a case that set its varied inputs."""
    return tuple(build_change(key, value, CAMPAIGN) for key, value in inputs.items())


def build_failed_row(run: PlannedRun, reason: str, wall_s: float) -> RunRow:
    """Row of a run without a result."""
    verdicts: dict[str, Verdict | None] = {"verdict": FAILED, "criteria_verdict": None, "verification_verdict": None}
    return RunRow(run, verdicts, " ".join(reason.split()), {}, wall_s)


@cache
def _choose_system(text: str, refined: bool, timeout_s: float) -> System:
    if text == "builtin" and not refined:
        from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator

        return UnrefinedSimulator()
    return choose_system(text, timeout_s)


def _build_row(run: PlannedRun, result: CaseResult, missing: Sequence[str], wall_s: float) -> RunRow:
    """Row of a graded run; a rule without a bound is a skipped criterion, so that the run cannot pass."""
    skipped: list[Verdict] = ["skip"] if missing else []
    verdicts: dict[str, Verdict | None] = {
        "verdict": worst_verdict([result.verdict, *skipped]),
        "criteria_verdict": worst_verdict([result.criteria_verdict or result.verdict, *skipped]),
        "verification_verdict": None if result.verification is None else result.verification.verdict,
    }
    reason = result.reason or ("; ".join(missing) or None)
    quantities, widths = (dict(_name_quantities(values)) for values in (result.quantities, result.uncertainty))
    return RunRow(run, verdicts, reason, quantities, wall_s, widths)


def _find_balance_forces(case: Case, result: CaseResult) -> tuple[float, ...]:
    """Uplift forces of a tuned run, corrected by the remaining deviation from its target mean force."""
    forces = find_uplift_forces(result.derived)
    means = [result.quantities.get(str(number), {}).get("mean_force_N") for number in range(1, len(forces) + 1)]
    if not forces or not all(isinstance(mean, float) for mean in means):
        return ()
    targets = [lift.target_mean_force for lift in case.lift_forces]
    return tuple(
        force if target is None else force + (target - mean) / START_SLOPE
        for force, mean, target in zip(forces, cast(list[float], means), targets, strict=True)
    )


def _name_quantities(quantities: Mapping[str, Mapping[str, Number]]) -> Iterator[tuple[str, float]]:
    """Column and value of every quantity; the items of a list are numbered from 1."""
    for owner, values in quantities.items():
        for name, value in values.items():
            for item, number in enumerate(value, 1) if isinstance(value, list) else ((None, value),):
                yield name_column(owner, name, item), number


def name_column(owner: str, quantity: str, item: int | None = None) -> str:
    """Name of the column of a value: number of the pantograph (0: line), quantity, and number of the item in a list."""
    return f"{owner}.{quantity}" + ("" if item is None else f"[{item}]")
