"""Quantities from other distributions: the entry point has the name of the quantity, which begins with `own_`."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.plug_ins.plug_in import PlugIn, find_plug_in
from pantocheck.conformance.plug_ins.plug_in_loading import guard_plug_in, load_plug_in
from pantocheck.conformance.quantities.force_quantities import FORCE, FORCE_20, FORCE_50, HEIGHT
from pantocheck.conformance.quantities.force_signals import ForceSignals
from pantocheck.conformance.quantities.quantity import Need, PantographQuantity
from pantocheck.conformance.quantities.sampling import WHOLE_RECORD, Sampling
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable

OWN = "own_"
"""Beginning of the names of quantities from outside; no quantity of the suite has it."""

ForceNeed = Literal["force", "force_20", "force_50", "height"]

NEEDS: dict[ForceNeed, Need[ForceSignals]] = {
    "force": FORCE,
    "force_20": FORCE_20,
    "force_50": FORCE_50,
    "height": HEIGHT,
}
"""Parts of a record that a quantity can need."""

LONGEST_UNIT = 20
LONGEST_DEFINITION = 300
"""Largest numbers of characters, so that both fit into the columns of pages."""


@dataclass(frozen=True)
class ForceQuantity:
    """A statistic of the contact force of one pantograph, the object of an entry point `pantocheck.quantities`.

    Parameters
    ----------
    unit : str
        Unit as printed; empty for a ratio.
    definition : str
        Definition in one sentence.
    needs : {"force", "force_20", "force_50", "height"}
        Part of a record without which the quantity is skipped.
    compute : callable
        Function of `ForceSignals` and of a `Sampling`, whose methods `mean`, `std`, `largest` and so on give one number
        for the record, and one number for each replicate of the bootstrap, from which the uncertainty follows.
    """

    unit: str
    definition: str
    needs: ForceNeed
    compute: Callable[[ForceSignals, Sampling], RealArray]


class PlugInFailed(QuantityUnavailable):
    """The code of a plug-in failed: its quantity has no value, and the other quantities keep theirs."""


def find_own_quantity(name: str) -> PantographQuantity | None:
    """Quantity from outside by its name; None if no distribution offers it.

    Raises
    ------
    InputError
        Two distributions offer it, or it cannot be loaded.
    """
    plug_in = find_plug_in("quantity", name) if name.startswith(OWN) else None
    return None if plug_in is None else _load_quantity(plug_in)


def select_own(names: Iterable[str]) -> tuple[str, ...]:
    """Names of quantities from outside among some names, each once."""
    return tuple(dict.fromkeys(name for name in names if name.startswith(OWN)))


def list_own_quantities(names: Iterable[str]) -> tuple[PantographQuantity, ...]:
    """Installed quantities among some names from outside."""
    found = map(find_own_quantity, names)
    return tuple(quantity for quantity in found if quantity is not None)


@cache
def _load_quantity(plug_in: PlugIn) -> PantographQuantity:
    stated = load_plug_in(plug_in, ForceQuantity)
    texts = {"unit": (stated.unit, LONGEST_UNIT), "definition": (stated.definition, LONGEST_DEFINITION)}
    for key, (text, longest) in texts.items():
        if not isinstance(text, str) or not text.isprintable() or len(text) > longest:
            raise InputError(
                plug_in.text, f"key {key} is {text!r:.60}", f"Give a text of at most {longest} characters."
            )
    if stated.needs not in NEEDS:
        raise InputError(plug_in.text, f"key needs is {stated.needs!r:.60}", f"Give one of {', '.join(NEEDS)}.")
    if not callable(stated.compute):
        raise InputError(plug_in.text, "key compute is no function", "Give a function of signals and sampling.")

    def compute(signals: ForceSignals, sampling: Sampling) -> RealArray:
        try:
            with guard_plug_in(plug_in):
                return _check_value(stated.compute(signals, sampling), sampling)
        except InputError as error:
            raise PlugInFailed(f"{error.where} {error.found}") from None

    return PantographQuantity(
        name=plug_in.name,
        label=plug_in.name,
        unit=stated.unit,
        definition=stated.definition,
        needs=NEEDS[stated.needs],
        source=f"{plug_in.distribution} {plug_in.version}",
        compute=compute,
    )


def _check_value(value: object, sampling: Sampling) -> RealArray:
    """Finite numbers: one for the whole record; a bootstrap asks for one per replicate."""
    numbers = np.asarray(value, dtype=np.float64)
    if not np.isfinite(numbers).all() or (sampling is WHOLE_RECORD and numbers.shape != ()):
        raise ValueError(f"expected a finite number, found {str(value)[:60]}")
    return numbers
