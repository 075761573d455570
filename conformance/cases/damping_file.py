"""Damping of a line: per component kind, and per mode.

The names say what is multiplied, because papers disagree on which of alpha and beta belongs to the stiffness.
"""

from itertools import pairwise
from typing import Annotated

from pydantic import Field, model_validator

from pantocheck.conformance.input_files.sourced_table import PROVENANCE, InputTable, SourcedTable, validation_problem
from pantocheck.conformance.input_files.trust import LEVELS


class ComponentDamping(InputTable):
    """Rayleigh damping of one kind of component: C = mass_coefficient M + stiffness_coefficient K."""

    mass_coefficient_1_s: Annotated[float, Field(ge=0, le=100, description="multiplies the mass matrix [1/s]")] = 0.0
    stiffness_coefficient_s: Annotated[float, Field(ge=0, le=10, description="multiplies the stiffness matrix [s]")] = (
        0.0
    )


class ModalDamping(InputTable):
    """Damping ratio of all modes of the undamped line in a frequency band; Rayleigh damping is compensated there."""

    from_Hz: Annotated[float, Field(ge=0, le=1000, description="lower edge of the band [Hz]")]
    to_Hz: Annotated[float, Field(gt=0, le=1000, description="upper edge of the band [Hz]")]
    damping_ratio: Annotated[float, Field(ge=0, lt=1, description="share of critical damping [-]")]

    @model_validator(mode="after")
    def _ordered(self) -> "ModalDamping":
        if self.from_Hz >= self.to_Hz:
            raise validation_problem(
                "from_Hz", f"{self.from_Hz:g} Hz is not below to_Hz = {self.to_Hz:g} Hz", "Exchange them."
            )
        return self


class Damping(SourcedTable):
    """Damping of the line at rest; a component kind that is left out has none."""

    contact_wire: ComponentDamping = ComponentDamping()
    messenger_wire: ComponentDamping = ComponentDamping()
    stitch_wire: ComponentDamping = ComponentDamping()
    droppers: ComponentDamping = ComponentDamping()
    steady_arms: ComponentDamping = ComponentDamping()
    modal: Annotated[
        tuple[ModalDamping, ...],
        Field(strict=False, max_length=1000, description="bands with a damping ratio of their own"),
    ] = ()

    @model_validator(mode="after")
    def _bands_apart(self) -> "Damping":
        ordered = sorted(self.modal, key=lambda band: band.from_Hz)
        for before, after in pairwise(ordered):
            if after.from_Hz < before.to_Hz:
                raise validation_problem(
                    "modal",
                    f"the bands {before.from_Hz:g}-{before.to_Hz:g} Hz and {after.from_Hz:g}-"
                    f"{after.to_Hz:g} Hz overlap",
                    "A mode can only have one damping ratio.",
                )
        return self


class DampingFile(InputTable):
    """A damping model in a file of its own, as `pantocheck fit-damping` writes it."""

    damping: Damping


def overlay_damping(damping: Damping, over: Damping) -> Damping:
    """Damping of a line with another laid over it: the kinds and modal bands of `over` replace its own."""
    said = over.model_fields_set - PROVENANCE
    kinds = {"contact_wire", "messenger_wire", "stitch_wire", "droppers", "steady_arms"}
    kept = kinds & damping.model_fields_set - said
    changes: dict[str, object] = {key: getattr(over, key) for key in (*said, *PROVENANCE)}
    if kept:
        changes["trust"] = max(damping.trust, over.trust, key=LEVELS.index)
        changes["source"] = list(dict.fromkeys((*_listed(over.source), *_listed(damping.source))))
    # A modal band keeps its meaning only with the model it was fitted with.
    return damping.model_copy(update={"modal": (), **changes})


def _listed(source: str | list[str]) -> list[str]:
    return [source] if isinstance(source, str) else source
