"""Evaluation of signals: available quantities, and the reasons why other quantities are not available."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals, PantographSignals
from pantocheck.conformance.quantities.stated_quantities import list_stated
from pantocheck.conformance.quantities.statistics import WHOLE_RECORD
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable

Value = float | tuple[float, ...]
"""A number, or one number per dropper or mode."""

ValuesByOwner = Mapping[int, Mapping[str, Value]]
"""Values by pantograph (0: the line) and by name of the quantity."""

LINE = 0
"""Key of the line, in place of the number of a pantograph."""


@dataclass(frozen=True)
class Evaluation:
    """Quantities of a run, by pantograph (from 1 in running order; 0: the line) and name."""

    values: dict[int, dict[str, Value]]
    """Available quantities."""
    skipped: dict[int, dict[str, str]]
    """Reasons why the other quantities are not available."""


class ChannelSignals(Protocol):
    """Signals of a record, whose quantities can be computed over any section, and from changed channels."""

    @property
    def pantographs(self) -> Mapping[int, PantographSignals]:
        """Signals by number from 1."""

    @property
    def line(self) -> LineSignals:
        """Uplift at the supports."""

    @property
    def evaluation(self) -> Evaluation:
        """Quantities over the analysis section."""

    @property
    def _sections(self) -> dict[tuple[float, float], Evaluation]:
        """Evaluations of other sections, which several components of the uncertainty share."""

    def evaluate_channels(self, pantographs: Mapping[int, PantographSignals], line: LineSignals) -> Evaluation:
        """Evaluate the quantities of other channels over the analysis section."""

    def evaluate_section(self, section: tuple[float, float]) -> Evaluation:
        """Evaluate the quantities over another section [m, m], once; the force is not filtered again."""


class SectionEvaluations:
    """Evaluations over other sections, for a class with the other parts of `ChannelSignals`."""

    @cached_property
    def _sections(self) -> dict[tuple[float, float], Evaluation]:
        return {}

    def evaluate_section(self: ChannelSignals, section: tuple[float, float]) -> Evaluation:
        """Evaluate the quantities over another section [m, m], once; the force is not filtered again."""
        if section not in self._sections:
            moved = {number: replace(signals, section=section) for number, signals in self.pantographs.items()}
            self._sections[section] = self.evaluate_channels(moved, replace(self.line, section=section))
        return self._sections[section]


def build_empty_evaluation(reason: str, pantographs: Iterable[int]) -> Evaluation:
    """Evaluation of a record that supports no quantity, for one reason."""
    owners = {LINE: LINE_QUANTITIES} | dict.fromkeys(pantographs, PANTOGRAPH_QUANTITIES)
    skipped = {owner: {quantity.name: reason for quantity in quantities} for owner, quantities in owners.items()}
    return Evaluation({owner: {} for owner in owners}, skipped)


def evaluate_signals(pantographs: Mapping[int, ForceSignals], line: LineSignals) -> Evaluation:
    """Evaluate all quantities of a record; an unavailable quantity is skipped with the reason.

    Args:
        pantographs: Signals of the pantographs by number from 1.
        line: Uplift at the supports.

    Returns:
        Values and skipped quantities.
    """
    values: dict[int, dict[str, Value]] = {LINE: {}}
    skipped: dict[int, dict[str, str]] = {LINE: {}}
    for pantograph, signals in pantographs.items():
        values[pantograph], skipped[pantograph] = {}, {}
        for quantity in (*PANTOGRAPH_QUANTITIES, *list_stated(signals)):
            try:
                quantity.needs.check(signals)
                values[pantograph][quantity.name] = float(quantity.compute(signals, WHOLE_RECORD))
            except QuantityUnavailable as reason:
                skipped[pantograph][quantity.name] = str(reason)
    for line_quantity in LINE_QUANTITIES:
        try:
            line_quantity.needs.check(line)
            values[LINE][line_quantity.name] = line_quantity.compute(line)
        except QuantityUnavailable as reason:
            skipped[LINE][line_quantity.name] = str(reason)
    return Evaluation(values, skipped)
