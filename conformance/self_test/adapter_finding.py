"""Finding of the check of an adapter."""

from dataclasses import dataclass
from typing import Literal

FindingState = Literal["ok", "missing", "wrong", "note"]


@dataclass(frozen=True)
class AdapterFinding:
    """One line of the check: its state, its subject, and a text that says what to do next."""

    state: FindingState
    subject: str
    text: str
