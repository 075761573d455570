"""Signals of a record, filtered once and shared by quantities, traces, section spread and consistency checks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from pantocheck.conformance.quantities.evaluation import Evaluation, SectionEvaluations, evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.quantities.stated_quantities import Stretch, evaluate_outside_overlaps
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.uplift_sensor import refuse_faulty_uplift


@dataclass(frozen=True)
class RecordSignals(SectionEvaluations):
    """Signals of a record over its analysis section."""

    record: Record
    """Record of a run or a measurement."""
    low_pass: Filter
    """Filter of the graded force."""
    line_supports: tuple[float, ...] | None = None
    """Positions of all supports of the line [m]; None if they are not known."""
    overlaps: Sequence[Stretch] = ()
    """Overlaps of the tension sections of the line."""
    run: tuple[float, float] | None = None
    """Positions of the first pantograph at the start, and of the last one at the end, of the run of the case [m]."""

    @cached_property
    def pantographs(self) -> dict[int, PantographSignals]:
        """Signals of the pantographs, by number from 1."""
        record = self.record
        return {
            row + 1: PantographSignals(
                position=record.position[row],
                force=ForceChannel(record.force[row], record.rate, self.low_pass, record.filter_applied_Hz),
                section=record.evaluated,
                contact_height=None if record.contact_height is None else record.contact_height[row],
                front_strip=None if record.front_strip is None else record.front_strip[row],
            )
            for row in range(record.pantographs)
        }

    @cached_property
    def line(self) -> LineSignals:
        """Uplift at the supports; of a sensor with a fault, none counts."""
        return refuse_faulty_uplift(self.delivered_line, self.record.position, self.run and self.run[0])

    @cached_property
    def delivered_line(self) -> LineSignals:
        """Uplift at the supports as delivered, for the checks of its passages."""
        record = self.record
        return LineSignals(
            record.evaluated,
            record.support_position,
            record.support_uplift,
            self.line_supports,
            record.position.min(axis=0),
            run_end=self.run and self.run[1],
        )

    @cached_property
    def evaluation(self) -> Evaluation:
        """Quantities over the analysis section of the record."""
        return self.evaluate_channels(self.pantographs, self.line)

    def evaluate_channels(self, pantographs: Mapping[int, PantographSignals], line: LineSignals) -> Evaluation:
        """Evaluate the quantities of other channels over the analysis section."""
        return self._add_stretches(evaluate_signals(pantographs, line), pantographs)

    def _add_stretches(self, evaluation: Evaluation, pantographs: Mapping[int, PantographSignals]) -> Evaluation:
        """Add the quantities outside of the overlaps."""
        values, skipped = evaluate_outside_overlaps(pantographs, self.overlaps)
        return Evaluation(
            {owner: {**known, **values.get(owner, {})} for owner, known in evaluation.values.items()},
            {owner: {**known, **skipped.get(owner, {})} for owner, known in evaluation.skipped.items()},
        )


def evaluate_record(
    record: Record,
    low_pass: Filter,
    line_supports: tuple[float, ...] | None = None,
    run: tuple[float, float] | None = None,
) -> Evaluation:
    """Evaluate every quantity of a record over its analysis section; see `RecordSignals`."""
    return RecordSignals(record, low_pass, line_supports, run=run).evaluation
