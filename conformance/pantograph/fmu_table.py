"""Table `fmu` of a pantograph file: a Functional Mock-up Unit that moves the pantograph in place of its linear model.

The linear model of the file states the response that the FMU is expected to have; the checks of a record use it.
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, is_absent, validation_problem

VariableName = Annotated[str, Field(min_length=1, max_length=500)]
StripVariables = Annotated[
    tuple[VariableName, ...], Field(strict=False, min_length=1, max_length=2, description="one name per strip")
]
OptionalName = Annotated[VariableName | None, Field(exclude_if=is_absent), NO_FEATURE]


class FmuTable(InputTable):
    """FMU and the names of its variables. Units are those of its model description; without a unit, SI."""

    model: Annotated[str, Field(min_length=1, max_length=4000)]
    """Archive, relative to the pantograph file."""
    sha256: Annotated[str | None, Field(pattern="^[0-9a-f]{64}$"), NO_FEATURE] = None
    """Digest of the archive; another archive is refused."""
    interface: Annotated[Literal["co-simulation", "model-exchange"], NO_FEATURE] = "co-simulation"
    """Interface of the FMU that is used."""
    contact_force_N: StripVariables
    """Input of the contact force of each strip, from front to rear."""
    contact_force_positive: Annotated[Literal["down", "up"], NO_FEATURE] = "down"
    """Direction in which a positive contact force acts on the head."""
    head_height_m: StripVariables
    """Output of the height of each strip, upwards."""
    working_height_m: float
    """Value of this output at the static working height of the case [m]."""
    uplift_force_N: OptionalName = None
    """Input or parameter of the uplift force; default: the FMU has the uplift force of the case."""
    train_speed_km_h: OptionalName = None
    """Input or parameter of the speed of the train."""
    base_height_m: OptionalName = None
    """Input of the height of the base, which is 0 on a level track."""
    parameters: Annotated[dict[VariableName, float], Field(max_length=1000), NO_FEATURE] = Field(default_factory=dict)
    """Values of parameters, in the units of the FMU."""
    outputs: Annotated[
        tuple[VariableName, ...], Field(strict=False, max_length=100, exclude_if=is_absent), NO_FEATURE
    ] = ()
    """Further outputs and local variables that are recorded, in the units of the FMU."""
    is_linear: Annotated[bool, NO_FEATURE] = True
    """false: the motion differs from that of the linear model of this file, as with a controller or friction. The
    motion of a record is not confirmed then.
    """

    @cross_check
    def _has_one_height_per_force(self) -> Problems:
        forces, heights = len(self.contact_force_N), len(self.head_height_m)
        if forces != heights:
            yield validation_problem("head_height_m", f"{heights} names for {forces} forces", "Name one per strip.")

    @property
    def is_named(self) -> bool:
        """Whether the user has named the pantograph file: only then the FMU may run."""
        return Path(self.model).is_absolute()

    @property
    def file(self) -> str:
        """Name of the archive."""
        return Path(self.model).name

    def identify(self, path: Path) -> "FmuTable":
        """Table with the digest of the archive.

        Args:
            path: Pantograph file.

        Raises:
            InputError: There is no such archive, or it has another digest.
        """
        where = f"pantograph '{path.name}', key fmu"
        if Path(self.model).name != self.model:
            raise InputError(f"{where}.model", f"found {self.model!r}", "Keep the FMU beside the pantograph file.")
        digest = file_digest(path.parent / self.model)
        if self.sha256 not in (None, digest):
            raise InputError(f"{where}.sha256", f"the archive has {digest}", "Renew the key if you changed the FMU.")
        return self.model_copy(update={"sha256": digest})

    def name(self, path: Path) -> "FmuTable":
        """Table of a pantograph file that the user has named: the path of the archive is absolute."""
        return self.model_copy(update={"model": str((path.parent / self.model).absolute())})
