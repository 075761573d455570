"""Pantograph files: a chain of lumped masses, or the matrices or modes of a linear model."""

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
    """Lumped masses from the base upwards; spring and damper i connect mass i to mass i - 1, the first to the base."""

    names: Annotated[
        tuple[str, ...] | None,
        Field(strict=False, description="names of the masses, e.g. frame and head"),
    ] = None
    masses_kg: Annotated[PositiveList, Field(max_length=20, description="lumped masses, base to head [kg]")]
    stiffness_N_m: Annotated[NonNegativeList, Field(max_length=20, description="springs, base to head [N/m]")]
    damping_N_s_m: Annotated[NonNegativeList, Field(max_length=20, description="dampers, base to head [N s/m]")]

    uplift_force_on: Annotated[
        int | str, Field(description="mass that carries the uplift force: its number from the base, or its name")
    ] = 1
    base_spring_unstretched: Annotated[
        Literal["working_height", "wire_height"],
        Field(
            description="height at which the base spring is free of force: the static working height (the static "
            "contact force then equals the uplift force) or the nominal height of the wire"
        ),
    ] = "working_height"

    @model_validator(mode="after")
    def _consistent(self) -> "ChainTable":
        _check_lengths(self, ("stiffness_N_m", "damping_N_s_m", "names"), len(self.masses_kg), "mass", "masses")
        on, names = self.uplift_force_on, self.names or ()
        if isinstance(on, str) and on not in names:
            raise validation_problem(
                "uplift_force_on", f"no mass has the name {on!r}", f"The names are: {', '.join(names) or 'none'}."
            )
        if isinstance(on, int) and not 1 <= on <= len(self.masses_kg):
            raise validation_problem(
                "uplift_force_on", f"there is no mass {on}", f"Masses are numbered 1 to {len(self.masses_kg)}."
            )
        return self

    @property
    def uplift_mass(self) -> int:
        """Index of the mass that carries the uplift force, 0 at the base."""
        if isinstance(self.uplift_force_on, str):
            return (self.names or ()).index(self.uplift_force_on)
        return self.uplift_force_on - 1


Matrix = Annotated[tuple[NumberList, ...], Field(strict=False, min_length=1, max_length=50)]


class MatricesTable(SourcedTable):
    """Matrices of a linear pantograph with fixed base; its uplift force equals its static contact force."""

    mass_kg: Annotated[Matrix, Field(description="mass matrix, row by row [kg]")]
    damping_N_s_m: Annotated[Matrix, Field(description="damping matrix, row by row [N s/m]")]
    stiffness_N_m: Annotated[Matrix, Field(description="stiffness matrix, row by row [N/m]")]
    head: Annotated[
        NumberList,
        Field(max_length=50, description="share of each unknown in the displacement of the head, e.g. [0, 0, 1]"),
    ]

    @model_validator(mode="after")
    def _possible(self) -> "MatricesTable":
        n = len(self.head)
        if not any(self.head):
            raise validation_problem("head", "all zeros", "Give the unknown of the head, or a sum of unknowns.")
        for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
            rows = getattr(self, key)
            if len(rows) != n or any(len(row) != n for row in rows):
                raise validation_problem(
                    key, f"not {n} rows of {n} values", "Matrices are square, with one row per value of head."
                )
            matrix = np.array(rows)
            if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-9 * float(np.abs(matrix).max())):
                raise validation_problem(key, "not symmetric", "Check the order of the values.")
            lowest, largest = np.linalg.eigvalsh(matrix)[[0, -1]]
            if lowest < -1e-9 * abs(largest) or (key == "mass_kg" and lowest <= 1e-12 * largest):
                raise validation_problem(
                    key,
                    f"its lowest eigenvalue is {lowest:.3g}",
                    "Eigenvalues of mass are positive, those of damping and stiffness not negative.",
                )
        return self


class ModesTable(SourcedTable):
    """Mass-normalised modes of a linear pantograph, base fixed, head free; uplift force as for matrices."""

    frequency_Hz: Annotated[
        NonNegativeList, Field(max_length=200, description="natural frequencies; 0 for a rigid-body motion [Hz]")
    ]
    damping_ratio: Annotated[NonNegativeList, Field(max_length=200, description="damping ratio of each mode [-]")]
    head_shape: Annotated[
        NumberList, Field(max_length=200, description="displacement of the head in each mode [kg^-1/2]")
    ]

    @model_validator(mode="after")
    def _same_length(self) -> "ModesTable":
        _check_lengths(self, ("damping_ratio", "head_shape"), len(self.frequency_Hz), "mode", "modes")
        if not any(self.head_shape):
            raise validation_problem("head_shape", "all zeros", "The head must move in at least one mode.")
        return self


class PantographFile(InputTable):
    """Content of a pantograph file: one of chain, matrices and modes, and the contact."""

    title: Annotated[str, Field(description="title in reports", max_length=200)]
    chain: ChainTable | None = None
    matrices: MatricesTable | None = None
    modes: ModesTable | None = None
    contact: ContactTable
    note: Annotated[str | None, Field(description="reason for a choice", max_length=4000)] = None

    @model_validator(mode="after")
    def _has_one_model(self) -> "PantographFile":
        models = [name for name in ("chain", "matrices", "modes") if getattr(self, name) is not None]
        hint = "Give one of the tables chain, matrices and modes."
        if not models:
            raise validation_problem("chain", "there is no model of the pantograph", hint)
        if len(models) > 1:
            raise validation_problem(models[-1], f"the pantograph is given by {' and '.join(models)}", hint)
        return self


def _check_lengths(table: InputTable, keys: tuple[str, ...], n: int, item: str, items: str) -> None:
    for key in keys:
        if (values := getattr(table, key)) is not None and len(values) != n:
            raise validation_problem(key, f"{len(values)} values for {n} {items}", f"Give one value per {item}.")
