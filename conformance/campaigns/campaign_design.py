"""Design of a campaign: every run is computed from its number, so that a plan of any length takes no memory."""

import operator
import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from math import prod
from typing import Any

from pantocheck.conformance.campaigns.campaign_file import InputLink
from pantocheck.conformance.campaigns.design_axes import DesignAxis, Inputs
from pantocheck.conformance.cases.input_changes import parse_value
from pantocheck.conformance.core.input_error import InputError, suggest_names

# Conditions on the inputs of a design, such as `speed_km_h <= 320` or `spacing_m < geometry.spans`.
RELATIONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "!=": operator.ne,
    "==": operator.eq,
    "<": operator.lt,
    ">": operator.gt,
}
"""Relations by their sign; longer signs come first, because `<` is a part of `<=`."""

_CONDITION = re.compile("(.+?)(" + "|".join(RELATIONS) + ")(.+)")


@dataclass(frozen=True)
class Condition:
    """Relation of a varied input to a value or to another varied input."""

    text: str
    """The condition as the user wrote it."""
    key: str
    """Varied input on the left."""
    relation: str
    """One of `RELATIONS`."""
    value: object
    """Value on the right, or the key of a varied input."""

    def holds(self, inputs: Inputs) -> bool:
        """Whether the inputs of a design meet the condition.

        Raises:
            InputError: The two sides cannot be compared.
        """
        right = inputs[self.value] if isinstance(self.value, str) and self.value in inputs else self.value
        try:
            return bool(RELATIONS[self.relation](inputs[self.key], right))
        except TypeError:
            found = f"compares {inputs[self.key]!r} with {right!r}"
            raise InputError(f"campaign, condition {self.text!r}", found, "Compare numbers with numbers.") from None


def parse_condition(text: str, keys: Collection[str]) -> Condition:
    """Parse a condition on varied inputs.

    Args:
        text: The condition: key, relation, and a value or another key.
        keys: Keys of the varied inputs.

    Raises:
        InputError: The text is no condition, or its key is not varied.
    """
    where = f"campaign, condition {text[:80]!r}"
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise InputError(where, "is no condition", "Write KEY RELATION VALUE, e.g. speed_km_h <= 320 .")
    key, relation, right = (part.strip() for part in match.groups())
    if key not in keys:
        raise InputError(where, f"{key!r} is not a varied input", suggest_names(key, list(keys)))
    return Condition(text, key, relation, right if right in keys else parse_value(right, where))


@dataclass(frozen=True)
class PlannedRun:
    """Run of a campaign."""

    number: int
    """Number of the run, from 1."""
    design: int
    """Number of the design, from 1; the same for all systems."""
    case_id: str
    """Id of the base case."""
    system: str
    """System as in the option `--system`."""
    inputs: Inputs
    """Values of the varied inputs by key."""


@dataclass(frozen=True)
class CampaignDesign:
    """Every base case with every combination of the axes, on every system.

    The case changes slowest, then the axes in their order; the system changes from run to run. A design that breaks a
    condition is left out; the numbers of the others stay.
    """

    case_ids: tuple[str, ...]
    """Ids of the base cases."""
    axes: tuple[DesignAxis, ...]
    """Axes of the grid; the last one changes fastest."""
    links: tuple[InputLink, ...]
    """Inputs that follow a varied input."""
    conditions: tuple[Condition, ...]
    """Conditions on the inputs."""
    systems: tuple[str, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the varied inputs, linked ones last."""
        return (*(key for axis in self.axes for key in axis.keys), *(link.key for link in self.links))

    @property
    def candidates(self) -> int:
        """Number of designs before the conditions."""
        return len(self.case_ids) * prod(len(axis) for axis in self.axes)

    def count_runs(self) -> int:
        """Count the runs; with conditions, all designs are computed one by one."""
        if not self.conditions:
            return self.candidates * len(self.systems)
        return sum(1 for _ in self.list_runs())

    def list_runs(self) -> Iterator[PlannedRun]:
        """List the runs in the order of their numbers, one at a time."""
        for design in range(self.candidates):
            case_id, inputs = self._locate(design)
            if all(condition.holds(inputs) for condition in self.conditions):
                for i, system in enumerate(self.systems):
                    number = design * len(self.systems) + i + 1
                    named = system.replace("{design}", str(design + 1))
                    yield PlannedRun(number, design + 1, case_id, named, inputs)

    def _locate(self, design: int) -> tuple[str, Inputs]:
        """Id of the base case and inputs of a design, by the digits of its number in the lengths of the axes."""
        rows: list[Inputs] = []
        for axis in reversed(self.axes):
            design, place = divmod(design, len(axis))
            rows.append(axis.row(place))
        inputs: Inputs = {}
        for row in reversed(rows):
            inputs |= row
        for link in self.links:
            inputs[link.key] = link.factor * inputs[link.follows] + link.offset
        return self.case_ids[design], inputs
