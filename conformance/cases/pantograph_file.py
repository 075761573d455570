"""Pantograph files: a chain of lumped masses, or what a test rig gives: matrices, or modes."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegativeList,
    NumberList,
    Positive,
    PositiveList,
    SourcedTable,
    validation_problem,
)


class ContactTable(SourcedTable):
    """Contact between the head and the contact wire: a one-sided penalty spring."""

    stiffness_N_m: Annotated[Positive, Field(le=1e8, description="stiffness of the contact [N/m]")]


class ChainTable(SourcedTable):
    """Lumped masses numbered from the base upwards; spring and damper i join mass i to mass i - 1 (1: to the base)."""

    names: Annotated[
        tuple[str, ...] | None,
        Field(strict=False, description="what the masses are called, e.g. frame and head"),
    ] = None
    masses_kg: Annotated[PositiveList, Field(max_length=20, description="lumped masses, base to head [kg]")]
    stiffness_N_m: Annotated[NonNegativeList, Field(max_length=20, description="springs, base to head [N/m]")]
    damping_N_s_m: Annotated[NonNegativeList, Field(max_length=20, description="dampers, base to head [N s/m]")]

    uplift_force_on: Annotated[
        int | str, Field(description="mass the uplift force acts on: its number from the base, or its name")
    ] = 1
    base_spring_unstretched: Annotated[
        Literal["working_height", "wire_height"],
        Field(
            description="height at which the spring to the base carries nothing: the static working height (the static "
            "contact force is then the uplift force) or the nominal height of the wire"
        ),
    ] = "working_height"

    @model_validator(mode="after")
    def _same_length(self) -> "ChainTable":
        n = len(self.masses_kg)
        for key in ("stiffness_N_m", "damping_N_s_m", "names"):
            value = getattr(self, key)
            if value is not None and len(value) != n:
                raise validation_problem(
                    key, f"{len(value)} values for {n} masses", "Give one value per mass, base to head."
                )
        return self

    @model_validator(mode="after")
    def _force_has_a_mass(self) -> "ChainTable":
        on, names = self.uplift_force_on, self.names or ()
        if isinstance(on, str) and on not in names:
            raise validation_problem(
                "uplift_force_on", f"no mass is called {on!r}", f"Names are: {', '.join(names) or 'none'}."
            )
        if isinstance(on, int) and not 1 <= on <= len(self.masses_kg):
            raise validation_problem(
                "uplift_force_on", f"there is no mass {on}", f"Masses are numbered 1 to {len(self.masses_kg)}."
            )
        return self

    @property
    def uplift_mass(self) -> int:
        """Index from 0, base to head, of the mass the uplift force acts on."""
        if isinstance(self.uplift_force_on, str):
            return (self.names or ()).index(self.uplift_force_on)
        return self.uplift_force_on - 1


Matrix = Annotated[tuple[NumberList, ...], Field(strict=False, min_length=1, max_length=50)]


class MatricesTable(SourcedTable):
    """A linear pantograph by its matrices, base fixed; its uplift force is its static contact force."""

    mass_kg: Annotated[Matrix, Field(description="mass matrix, row by row [kg]")]
    damping_N_s_m: Annotated[Matrix, Field(description="damping matrix, row by row [N s/m]")]
    stiffness_N_m: Annotated[Matrix, Field(description="stiffness matrix, row by row [N/m]")]
    head: Annotated[
        NumberList, Field(max_length=50, description="displacement of the head per unknown, e.g. [0, 0, 1]")
    ]

    @model_validator(mode="after")
    def _possible(self) -> "MatricesTable":
        n = len(self.head)
        if not any(self.head):
            raise validation_problem("head", "all zeros", "Say which unknown, or which sum of unknowns, is the head.")
        for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
            rows = getattr(self, key)
            if len(rows) != n or any(len(row) != n for row in rows):
                raise validation_problem(
                    key, f"not {n} rows of {n} values", "The matrices are square, one row per value of head."
                )
            matrix = np.array(rows)
            if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-9 * float(np.abs(matrix).max())):
                raise validation_problem(key, "not symmetric", "Check the order of its values.")
            lowest, largest = np.linalg.eigvalsh(matrix)[[0, -1]]
            if lowest < -1e-9 * abs(largest) or (key == "mass_kg" and lowest <= 1e-12 * largest):
                raise validation_problem(
                    key,
                    f"its lowest eigenvalue is {lowest:.3g}",
                    "A mass matrix has positive eigenvalues, damping and stiffness none below zero.",
                )
        return self


class ModesTable(SourcedTable):
    """A linear pantograph by its mass-normalised modes, base fixed, head free; uplift force as for matrices."""

    frequency_Hz: Annotated[
        NonNegativeList, Field(max_length=200, description="natural frequencies; 0 for a motion without stiffness [Hz]")
    ]
    damping_ratio: Annotated[NonNegativeList, Field(max_length=200, description="one value per mode [-]")]
    head_shape: Annotated[
        NumberList, Field(max_length=200, description="displacement of the head in each mode [kg^-1/2]")
    ]

    @model_validator(mode="after")
    def _same_length(self) -> "ModesTable":
        n = len(self.frequency_Hz)
        for key in ("damping_ratio", "head_shape"):
            if len(getattr(self, key)) != n:
                raise validation_problem(
                    key, f"{len(getattr(self, key))} values for {n} modes", "Give one value per mode."
                )
        if not any(self.head_shape):
            raise validation_problem(
                "head_shape", "all zeros", "A head that takes part in no mode cannot follow a wire."
            )
        return self


class PantographFile(InputTable):
    """A pantograph as simulators take it: exactly one of chain, matrices and modes, and its contact."""

    title: Annotated[str, Field(description="what it is", max_length=200)]
    chain: ChainTable | None = None
    matrices: MatricesTable | None = None
    modes: ModesTable | None = None
    contact: ContactTable
    note: Annotated[str | None, Field(description="why a choice is what it is", max_length=4000)] = None

    @model_validator(mode="after")
    def _said_once(self) -> "PantographFile":
        given = [name for name in ("chain", "matrices", "modes") if getattr(self, name) is not None]
        if len(given) != 1:
            found = (
                f"the pantograph is given by {' and '.join(given)}" if given else "there is no model of the pantograph"
            )
            raise validation_problem(
                given[-1] if given else "chain", found, "Give one of the tables chain, matrices and modes."
            )
        return self
