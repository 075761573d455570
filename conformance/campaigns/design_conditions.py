"""Conditions on the inputs of a design, such as `speed_km_h <= 320` or `spacing_m < geometry.spans`."""

import operator
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from pantocheck.conformance.campaigns.design_axes import Inputs
from pantocheck.conformance.cases.input_changes import parse_value
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names

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
