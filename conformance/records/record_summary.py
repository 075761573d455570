"""Summaries: published or measured statistics of a passage without samples."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.input_error import suggest_names
from pantocheck.conformance.core.sourced_table import Problems, SourcedTable, cross_check, validation_problem
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.stated_quantities import STATED_QUANTITIES
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, statistical_extremes
from pantocheck.conformance.records.record import LARGEST_NUMBER
from pantocheck.conformance.records.sidecar_tables import PassageTable

SummaryValue = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
SummaryValues = Annotated[dict[str, SummaryValue], Field(max_length=100)]


class RecordSummary(PassageTable, SourcedTable):
    """Quantities of a passage by name, for each pantograph and for the line."""

    schema_: Annotated[Literal["pantocheck.summary/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.summary/1"."""
    filter_cutoff_Hz: Annotated[float, Field(gt=0, le=1000)]
    """Cut-off of the low-pass filter of the force statistics [Hz]."""
    pantograph: Annotated[tuple[SummaryValues, ...], Field(strict=False, min_length=1, max_length=20)]
    """Quantities by name, one table per pantograph."""
    quantities: Annotated[SummaryValues, Field(default_factory=dict)]
    """Quantities of the line by name."""

    @cross_check
    def _check_values(self) -> Problems:
        known = [quantity.name for quantity in (*PANTOGRAPH_QUANTITIES, *STATED_QUANTITIES)]
        for i, values in enumerate(self.pantograph, 1):
            yield from _find_table_problems(values, f"pantograph[{i}]", known)
        static = [quantity.name for quantity in QUANTITIES.values() if quantity.scope == "static"]
        known = [*(quantity.name for quantity in LINE_QUANTITIES), *static]
        yield from _find_table_problems(self.quantities, "quantities", known)

    @property
    def evaluation(self) -> Evaluation:
        """Quantities in the form of an evaluated record; quantities that are not stated are skipped."""
        values: dict[int, dict[str, Value]] = {
            LINE: {name: self.quantities[name] for name in QUANTITIES if name in self.quantities}
        }
        skipped = {LINE: {q.name: _NOT_GIVEN for q in LINE_QUANTITIES if q.name not in self.quantities}}
        for i, known in enumerate(self.pantograph, 1):
            values[i] = {name: known[name] for name in QUANTITIES if name in known}
            skipped[i] = {q.name: _NOT_GIVEN for q in PANTOGRAPH_QUANTITIES if q.name not in known}
        return Evaluation(values, skipped)

    @property
    def contradictions(self) -> tuple[str, ...]:
        """Statistics that contradict mean and standard deviation of the same table; printed tables have such errors."""
        contradictions = []
        for i, values in enumerate(self.pantograph, 1):
            for name, expected, rounding in _derive_statistics(values):
                if name in values and not abs(values[name] - expected) <= rounding:
                    contradictions.append(
                        f"{name} of pantograph {i} is {values[name]:g}, but mean and standard deviation "
                        f"give {expected:.4g}"
                    )
        return tuple(contradictions)


_NOT_GIVEN = "the summary does not state this quantity"


def _derive_statistics(values: dict[str, float]) -> list[tuple[str, float, float]]:
    """Name, value and rounding error of each statistic that follows from mean and standard deviation."""
    mean, std = values.get("mean_force_N"), values.get("std_force_N")
    if mean is None or std is None:
        return []
    low, high = statistical_extremes(mean, std)
    # Numbers are printed to 0.1 N at best: 0.05 N of rounding in mean and extreme, three times 0.05 N in 3 sigma.
    derived = [("statistical_min_N", low, 0.3), ("statistical_max_N", high, 0.3)]
    return [*derived, ("cov_20", coefficient_of_variation(mean, std), 0.006)] if mean > 0 else derived


def _find_table_problems(values: dict[str, float], table: str, known: list[str]) -> Problems:
    for name, value in values.items():
        if name not in known:
            yield validation_problem(
                f"{table}.{name[:80]}", "not a quantity of this table", suggest_names(name[:80], known)
            )
            continue
        if value < 0 and QUANTITIES[name].never_negative:
            yield validation_problem(
                f"{table}.{name}", f"{value:g} is negative", QUANTITIES[name].definition.capitalize() + "."
            )
        if value > 100 and name.endswith("_pct"):
            yield validation_problem(f"{table}.{name}", f"{value:g} % is above 100 %", "Give a value from 0 to 100 %.")
    low, high = values.get("min_force_N"), values.get("max_force_N")
    if low is not None and high is not None and low > high:
        yield validation_problem(
            f"{table}.min_force_N", f"{low:g} is above max_force_N = {high:g}", "Correct the wrong value."
        )
