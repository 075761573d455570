"""Model uncertainty of the reference simulator: sizes of effects that its equations leave out, from the library."""

from functools import cache
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.limits import QuantityName
from pantocheck.conformance.input_files.sourced_table import InputTable, Positive
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.quantities.registry import QUANTITIES

FILE = "model_uncertainty.toml"
"""File of the library."""

Sizes = Annotated[dict[QuantityName, Positive], Field(default_factory=dict)]


class Effect(InputTable):
    """Effect that the equations leave out, and its size on one line."""

    along_track: Literal["free", "fixed"]
    """Lines that it concerns: fixed: those with a fixed messenger_support."""
    effect: Annotated[str, Field(max_length=200)]
    """Equation of the simulator and effect that it leaves out."""
    compared: Annotated[str, Field(max_length=200)]
    """Line, speed and mesh of the comparison."""
    source: str
    """Source of the sizes: a key of sources.toml, or free text."""
    relative_pct: Sizes
    """Size of the effect on quantities, relative to the value [%]."""
    absolute: Sizes
    """Size of the effect on quantities, in their units."""

    @property
    def sentence(self) -> str:
        """Sizes in one sentence for the reader of a report."""
        labels = {name: quantity.label for name, quantity in QUANTITIES.items()}
        sizes = [f"{labels[name]}: {size:g} %" for name, size in self.relative_pct.items()]
        sizes += [f"{labels[name]}: {size:g} {QUANTITIES[name].unit}" for name, size in self.absolute.items()]
        return f"{self.effect} ({self.compared}). {'; '.join(sizes)}. Source: {source_text(self.source)}."


class ModelUncertaintyFile(InputTable):
    """Content of the file of model uncertainties."""

    effect: Annotated[tuple[Effect, ...], Field(strict=False)]
    """Effects that the equations leave out."""


@cache
def read_effects() -> tuple[Effect, ...]:
    """Effects of the library."""
    return read_model(library_folder() / FILE, ModelUncertaintyFile, "model uncertainty").effect


def list_model_uncertainty(case: Case) -> tuple[str, ...]:
    """Sentences on the effects that the reference simulator leaves out in a passage of a case."""
    along_track = "fixed" if case.line.layout.supports_fixed_along_track else "free"
    return tuple(effect.sentence for effect in read_effects() if effect.along_track == along_track)
