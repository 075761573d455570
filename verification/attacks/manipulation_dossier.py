"""Files of a run that a manipulation changes."""

import random
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

STEMS = ("position", "force", "contact_height", "uplift")
"""Start of the names of the columns, by kind of channel."""


@dataclass
class Dossier:
    """Files of a run: case, line, pantograph, columns of the table, sidecar, limits file; `other` is a second run."""

    case: dict[str, Any]
    line: dict[str, Any]
    pantograph: dict[str, Any]
    columns: dict[str, np.ndarray]
    sidecar: dict[str, Any]
    limits: dict[str, Any] | None
    other: "Dossier | None" = None

    def copy(self) -> "Dossier":
        """Copy whose tables can be changed; arrays are shared and must be replaced."""
        tables = {name: deepcopy(getattr(self, name)) for name in ("case", "line", "pantograph", "sidecar", "limits")}
        return replace(self, columns=dict(self.columns), **tables)

    def names(self, *stems: str) -> list[str]:
        """Columns of some kinds of channel."""
        return [name for name in self.columns if name.startswith(stems)]

    def choose(self, chance: random.Random, *stems: str) -> str | None:
        """Random column of some kinds of channel."""
        names = self.names(*stems)
        return chance.choice(names) if names else None


Manipulation = Callable[[Dossier, random.Random], str | None]
"""Change of a dossier; the result is the name of its kind, or None if it does not apply."""


def channel_kind(column: str) -> str:
    """Kind of channel of a column, by its name."""
    return next((stem for stem in STEMS if column.startswith(stem)), "time")
