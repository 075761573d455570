"""Explored case: passages of the reference simulator at settings of its sliders; the newest request wins."""

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock

from pantocheck.conformance.app.explorer.case_sliders import build_changes, list_sliders
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import InputChange
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.step_log import ShareCallback
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_shape import build_line_shape
from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.quantities.registry import QUANTITIES, unit_of
from pantocheck.conformance.records.traces import build_pantograph_traces, build_uplift_traces
from pantocheck.conformance.results.exploration_format import ExploredPassage, ExploredStretch, ExploredValue, Slider
from pantocheck.conformance.results.motion_format import PassageMotion
from pantocheck.conformance.runs.passage_motion import build_passage_motion
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model.description.failures import SimulationError

SHOWN_VALUES = (
    *("mean_force_N", "std_force_N", "max_force_N", "min_force_N", "statistical_max_N", "statistical_min_N"),
    *("rms_0_5_N", "rms_5_20_N", "rms_20_50_N", "contact_loss_pct"),
)
"""Values of a pantograph in the table, before others that have a limit."""

SHOWN_LINE_VALUES = ("max_uplift_at_support_mm",)


class Superseded(Exception):
    """A newer request has arrived; the answer would not be shown."""


@dataclass(frozen=True)
class Setting:
    """Simulated setting whose moving picture can be asked for."""

    number: int
    """Number of its request."""
    case: Case
    delivered: Delivered


@dataclass
class ExploredCase:
    """Case whose inputs a reader changes."""

    load: Callable[[Sequence[InputChange]], Case]
    """Function that reads the case with changed inputs."""
    name: str
    """Id or path of the case."""
    folders: tuple[Path, ...] = ()
    """Folders with further cases."""
    standing: tuple[str, ...] = ()
    """Inputs that are changed at every setting, as arguments of `--set`."""
    case: Case = field(init=False)
    """Case as its files state it."""
    sliders: list[Slider] = field(init=False)
    _newest: int = 0
    _latest: Setting | None = None
    _counting: Lock = field(default_factory=Lock)
    _computing: Lock = field(default_factory=Lock)

    def __post_init__(self) -> None:
        """Read the case."""
        self.case = self.load(())
        self.sliders = list_sliders(self.case)

    @property
    def source(self) -> dict[str, list[str]]:
        """Keys `cases` and `case_folders` of a campaign with the case, for any folder."""
        is_file = self.name.endswith(".toml")
        return {
            "cases": [str(Path(self.name).resolve()) if is_file else self.name],
            "case_folders": [str(folder.resolve()) for folder in self.folders],
        }

    def change(self, values: Mapping[str, float]) -> tuple[Case, tuple[InputChange, ...]]:
        """Case at a setting of the sliders, and its changes.

        Raises:
            InputError: A value is refused, or the changed files do not agree.
        """
        changes = build_changes(self.sliders, values)
        return (self.load(changes) if changes else self.case), changes

    def list_standing(self, changes: Sequence[InputChange]) -> list[str]:
        """Standing changes, as arguments of `--set`, that others do not replace."""
        keys = {change.key for change in changes}
        return [text for text in self.standing if text.partition("=")[0].strip() not in keys]

    def stop(self) -> None:
        """End a running computation."""
        with self._counting:
            self._newest += 1

    def simulate(self, values: Mapping[str, float]) -> ExploredPassage:
        """Simulate the passage at a setting, as `pantocheck simulate` does.

        Raises:
            InputError: A value is refused, or the changed files do not agree.
            SimulationError: The simulation fails.
            Superseded: A newer request has arrived.
        """
        case, changes = self.change(values)
        with self._counting:
            self._newest += 1
            number = self._newest
        with self._compute(number) as progress:
            delivered = ReferenceSimulator().run_unrefined(case, progress)
            self._latest = Setting(number, case, delivered)
            return self._describe(self._latest, changes)

    def build_motion(self, number: int) -> PassageMotion | None:
        """Moving picture of the simulated setting of a request; None if there is none.

        Raises:
            SimulationError: The simulation fails.
            Superseded: A newer request has arrived.
        """
        with self._compute(number) as progress:
            setting = self._latest
            if setting is None or setting.number != number:
                raise Superseded
            case, delivered = setting.case, setting.delivered
            discretisation = case.file.discretisation
            line = discretise_line(case.line, discretisation.element_m)
            shape = build_line_shape(case.line, case.analysed_spans, line)
            if delivered.record is None:
                return None
            return build_passage_motion(
                case, line, shape, discretisation, delivered.record, tuple(delivered.uplift_forces or ()), progress
            )

    @contextmanager
    def _compute(self, number: int) -> Iterator[ShareCallback]:
        """Wait for the computation before; yields a callback that ends this one when a newer request arrives."""

        def follow(share: float) -> None:
            if number != self._newest:
                raise Superseded

        with self._computing:
            follow(0.0)
            yield follow

    def _describe(self, setting: Setting, changes: Sequence[InputChange]) -> ExploredPassage:
        """Values, curves and line of a setting."""
        case, delivered = setting.case, setting.delivered
        evaluation = CaseEvaluation(case, delivered)
        if evaluation.signals is None or case.file.speed_km_h is None:
            raise SimulationError("the case gives no record of a passage")
        texts = [f"{change.key}={change.value!r}" for change in changes]
        options = [part for folder in self.folders for part in ("--cases", str(folder))]
        options += [part for text in (*self.list_standing(changes), *texts) for part in ("--set", text)]
        return ExploredPassage(
            id=case.id,
            number=setting.number,
            changes=texts,
            command=shlex.join(("pantocheck", "run", self.name, *options)),
            computing_s=delivered.run.wall_s or 0.0,
            run=ExploredStretch(
                speed_km_h=case.file.speed_km_h,
                evaluated_m=case.analysis_section,
                rate_Hz=float(f"{evaluation.signals.record.rate:.9g}"),
            ),
            criteria=list_explored_values(evaluation.evaluation.values, self.case.limits),
            traces=build_pantograph_traces(evaluation.signals.pantographs, case.line.geometry.span_limits),
            uplift=build_uplift_traces(evaluation.signals.line, evaluation.signals.record.time),
            line_shape=build_line_shape(
                case.line, case.analysed_spans, discretise_line(case.line, case.file.discretisation.element_m)
            ),
        )


def list_explored_values(values: ValuesByOwner, limits: Sequence[Limit]) -> list[ExploredValue]:
    """Rows of the table: the main values of every pantograph and of the line, and all that have a limit."""
    bounds = {limit.target: limit for limit in limits if limit.item is None}
    shown = [(name, owner, None) for owner in sorted(set(values) - {LINE}) for name in SHOWN_VALUES]
    shown += [(name, LINE, None) for name in SHOWN_LINE_VALUES]
    rows = []
    for target in dict.fromkeys((*shown, *bounds)):
        (name, owner, _), limit, value = target, bounds.get(target), find_value(target, values)
        lower, upper = (None, None) if limit is None else (limit.lower, limit.upper)
        rows.append(
            ExploredValue(
                quantity=name,
                label=QUANTITIES[name].label,
                unit=unit_of(name),
                pantograph=owner,
                value=value,
                lower=lower,
                upper=upper,
                is_inside=None if value is None or limit is None else judge(value, lower, upper) == "pass",
            )
        )
    return rows
