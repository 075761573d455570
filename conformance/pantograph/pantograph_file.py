"""Pantograph files: a chain of lumped masses, or the matrices or modes of a linear model."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from pydantic_core import PydanticCustomError

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    NonNegativeList,
    NumberList,
    Positive,
    PositiveList,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.pantograph.fmu_table import FmuTable
from pantocheck.conformance.pantograph.force_law import AppliedForceLaw, ForceLaw
from pantocheck.conformance.pantograph.head_tables import LISTED_BY_LAW, HeadTable
from pantocheck.conformance.pantograph.transfer_function import TransferFunctionTable
from pantocheck.conformance.pantograph.validity_range import SupportedRange
from pantocheck.model.description.contact_law import Force, contact_compliance, hertz_law_coefficient, penetration


def _is_default(value: object) -> bool:
    """Whether a key that came later has its default: it is left out of the digest of its file then."""
    return value in ("spring", 0.0, None)


class ContactTable(SourcedTable):
    """Contact between head and contact wire, in compression only: a spring, Hertz's law, or a constraint."""

    law: Annotated[Literal["spring", "hertz", "constraint"], Field(exclude_if=_is_default), Feature("contact_laws")] = (
        "spring"
    )
    """spring: linear; hertz: F = 4/3 E sqrt(R) penetration^1.5; constraint: head and wire touch without penetration."""
    stiffness_N_m: Annotated[Positive | None, Field(le=1e8, exclude_if=_is_default), NO_FEATURE] = None
    """Stiffness of the spring [N/m]."""
    damping_N_s_m: Annotated[NonNegative, Field(le=1e5, exclude_if=_is_default), Feature("contact_damping")] = 0.0
    """Damper beside the spring [N s/m]; it does not pull."""
    effective_modulus_N_m2: Annotated[Positive | None, Field(le=1e12, exclude_if=_is_default), NO_FEATURE] = None
    """Effective modulus E of Hertz's law, 1/E = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 of wire and strip [N/m2]."""
    effective_radius_m: Annotated[Positive | None, Field(le=10.0, exclude_if=_is_default), NO_FEATURE] = None
    """Effective radius R of Hertz's law; of crossed cylinders about the root of the product of both radii [m]."""

    @cross_check
    def _keys_fit_the_law(self) -> Problems:
        needed = {"spring": ("stiffness_N_m",), "hertz": ("effective_modulus_N_m2", "effective_radius_m")}
        for key in needed.get(self.law, ()):
            if getattr(self, key) is None:
                yield validation_problem(key, "missing", f"The law {self.law!r} needs this key.")
        allowed = (*needed.get(self.law, ()), *(("damping_N_s_m",) if self.law == "spring" else ()))
        for key in ("stiffness_N_m", "damping_N_s_m", "effective_modulus_N_m2", "effective_radius_m"):
            if key not in allowed and getattr(self, key):
                yield validation_problem(key, f"not a key of the law {self.law!r}", "Leave it out, or change the law.")

    @property
    def description(self) -> str:
        """Law in words, with the stiffness of a spring."""
        if self.stiffness_N_m is None:
            return {"hertz": "contact by the law of Hertz", "constraint": "contact by a constraint"}[self.law]
        return f"contact spring of {self.stiffness_N_m / 1000:g} kN/m"

    @property
    def hertz_coefficient(self) -> float:
        """Force per penetration^1.5 by Hertz's law; infinite with another law [N/m^1.5]."""
        if self.effective_modulus_N_m2 is None or self.effective_radius_m is None:
            return math.inf
        return hertz_law_coefficient(self.effective_modulus_N_m2, self.effective_radius_m)

    def penetration(self, force: Force) -> Force:
        """Penetration of head and wire under a contact force [m, N]."""
        return penetration(self.stiffness_N_m or math.inf, self.hertz_coefficient, force)

    def compliance(self, force: float) -> float:
        """Change of the penetration with the contact force, at a force [m/N, N]."""
        return contact_compliance(self.stiffness_N_m or math.inf, self.hertz_coefficient, force)


class ChainTable(SourcedTable):
    """Lumped masses, base to head; spring and damper i connect masses i - 1 and i, the first ones mass 1 and base."""

    names: Annotated[tuple[str, ...] | None, Field(strict=False), NO_FEATURE] = None
    """Names of the masses, base to head, e.g. frame and head."""
    masses_kg: Annotated[PositiveList, Field(max_length=20)]
    """Lumped masses, base to head [kg]."""
    stiffness_N_m: Annotated[NonNegativeList, Field(max_length=20)]
    """Springs, base to head [N/m]."""
    damping_N_s_m: Annotated[NonNegativeList, Field(max_length=20)]
    """Dampers, base to head [N s/m]."""

    uplift_force_on: Annotated[int | str, Feature("chain")] = 1
    """Mass on which the uplift force acts: number from the base, from 1, or name."""
    base_spring_unstretched: Annotated[
        Literal["working_height", "wire_height"], Feature("base_spring_at_wire_height")
    ] = "working_height"
    """Height from which the displacements of all masses count: with every mass at this height, all springs are
    without force; working_height: static height of the head under the uplift force; wire_height: nominal height of
    the contact wire.
    """

    @cross_check
    def _consistent(self) -> Problems:
        lists = ("stiffness_N_m", "damping_N_s_m", "names")
        yield from _find_wrong_lengths(self, lists, len(self.masses_kg), "mass", "masses")
        yield from self.find_wrong_mass("uplift_force_on", self.uplift_force_on)

    def find_wrong_mass(self, key: str, mass: int | str, others: tuple[str, ...] = ()) -> Problems:
        """Problem of a mass, by number from the base or by name, that the chain does not have.

        Args:
            key: Key that states it.
            mass: Number or name.
            others: Names of other parts that the key can state.
        """
        names = self.names or ()
        if isinstance(mass, str) and mass not in names:
            known = ", ".join((*names, *others)) or "not given"
            yield validation_problem(key, f"there is no mass {mass!r}", f"Known names are {known}.")
        if isinstance(mass, int) and not 1 <= mass <= len(self.masses_kg):
            yield validation_problem(key, f"there is no mass {mass}", f"Give a number from 1 to {len(self.masses_kg)}.")

    def mass_index(self, mass: int | str) -> int:
        """Index from 0 at the base of a mass, by number from the base, from 1, or by name."""
        return (self.names or ()).index(mass) if isinstance(mass, str) else mass - 1

    @property
    def uplift_mass(self) -> int:
        """Index of the mass on which the uplift force acts, from 0 at the base."""
        return self.mass_index(self.uplift_force_on)


Matrix = Annotated[tuple[NumberList, ...], Field(strict=False, min_length=1, max_length=50)]


class MatricesTable(SourcedTable):
    """Matrices of a linear pantograph with fixed base; springs are without force at the static working height."""

    mass_kg: Matrix
    """Mass matrix, row by row [kg]."""
    damping_N_s_m: Matrix
    """Damping matrix, row by row [N s/m]."""
    stiffness_N_m: Matrix
    """Stiffness matrix, row by row [N/m]."""
    head: Annotated[NumberList, Field(max_length=50)]
    """Displacement of the head per unit of each degree of freedom, e.g. [0, 0, 1]."""
    uplift_force_on: Annotated[NumberList | None, Field(max_length=50), Feature("matrices")] = None
    """Displacement of the point of the uplift force per unit of each degree of freedom, e.g. [1, 0, 0] for the
    lowest mass of a chain; default: the head, so that the static contact force at the working height equals the
    uplift force.
    """

    @cross_check
    def _possible(self) -> Problems:
        n = len(self.head)
        yield from _find_wrong_lengths(self, ("uplift_force_on",), n, "degree of freedom", "degrees of freedom")
        if not any(self.head):
            yield validation_problem("head", "all values are 0", "Give at least one value that is not 0.")
        for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
            rows = getattr(self, key)
            if len(rows) != n or any(len(row) != n for row in rows):
                yield validation_problem(
                    key, f"does not have {n} rows of {n} values", "Give a square matrix, one row per value of head."
                )
                continue
            matrix = np.array(rows)
            if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-9 * float(np.abs(matrix).max())):
                yield validation_problem(key, "the matrix is not symmetric", "Give a symmetric matrix, row by row.")
                continue
            lowest, largest = np.linalg.eigvalsh(matrix)[[0, -1]]
            if lowest < -1e-9 * abs(largest) or (key == "mass_kg" and lowest <= 1e-12 * largest):
                yield validation_problem(
                    key,
                    f"the lowest eigenvalue is {lowest:.3g}",
                    "Eigenvalues of the mass matrix are positive, those of damping and stiffness not negative.",
                )


class ModesTable(SourcedTable):
    """Mass-normalised modes of a linear pantograph with fixed base, free head; working height as for matrices."""

    frequency_Hz: Annotated[NonNegativeList, Field(max_length=200)]
    """Natural frequency of each mode, 0 for a rigid-body mode [Hz]."""
    damping_ratio: Annotated[NonNegativeList, Field(max_length=200)]
    """Damping ratio of each mode [-]."""
    head_shape: Annotated[NumberList, Field(max_length=200)]
    """Displacement of the head in each mode [kg^-1/2]."""
    uplift_force_on: Annotated[NumberList | None, Field(max_length=200), Feature("modes")] = None
    """Displacement of the point of the uplift force in each mode [kg^-1/2]; default: the head, as for matrices."""

    @cross_check
    def _same_length(self) -> Problems:
        yield from _find_wrong_lengths(
            self, ("damping_ratio", "head_shape", "uplift_force_on"), len(self.frequency_Hz), "mode", "modes"
        )
        if not any(self.head_shape):
            yield validation_problem("head_shape", "all values are 0", "Give at least one value that is not 0.")


MOTION_MODELS = ("chain", "matrices", "modes", "transfer_function")
"""Tables of a pantograph file that describe its motion."""


class PantographFile(InputTable):
    """Content of a pantograph file: contact, one table of `MOTION_MODELS`, structure of the head, and force law."""

    title: Annotated[str, Field(max_length=200)]
    """Title in reports."""
    chain: Annotated[ChainTable | None, Feature("chain")] = None
    matrices: Annotated[MatricesTable | None, Feature("matrices")] = None
    modes: Annotated[ModesTable | None, Feature("modes")] = None
    transfer_function: Annotated[
        TransferFunctionTable | None, Field(exclude_if=is_absent), Feature("transfer_function")
    ] = None
    fmu: Annotated[FmuTable | None, Field(exclude_if=is_absent), Feature("fmu")] = None
    """FMU that moves the pantograph in place of this model; the model states its expected response."""
    contact: ContactTable
    head: Annotated[HeadTable | None, Field(exclude_if=is_absent), LISTED_BY_LAW] = None
    """Strips, rotations, bending modes, friction and stops; default: the head is one rigid strip."""
    force_law: Annotated[
        ForceLaw | None,
        Field(exclude_if=is_absent),
        NO_FEATURE,  # a program receives the forces of the law at the speed of the case
    ] = None
    """Mean contact force or applied forces as a function of speed, for cases with force_from = 'law'; default: every
    case states a force.
    """
    validity: Annotated[SupportedRange | None, Field(exclude_if=is_absent), NO_FEATURE] = None
    """Highest frequency that the model supports; default: not known."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""

    @cross_check
    def _has_one_model(self) -> Problems:
        models = [name for name in MOTION_MODELS if getattr(self, name) is not None]
        hint = f"Give one of the tables {', '.join(MOTION_MODELS[:-1])} and {MOTION_MODELS[-1]}."
        if not models:
            yield validation_problem("chain", "missing", hint)
        if len(models) > 1:
            yield validation_problem(models[-1], f"the pantograph has {len(models)} models: {', '.join(models)}", hint)

    @cross_check
    def _fmu_fits_the_strips(self) -> Problems:
        if self.fmu is not None and len(self.fmu.contact_force_N) != self.strips:
            yield validation_problem(
                "fmu.contact_force_N", f"{len(self.fmu.contact_force_N)} names", f"The head has {self.strips} strips."
            )

    @cross_check
    def _law_fits_the_model(self) -> Problems:
        if isinstance(self.force_law, AppliedForceLaw):
            if self.transfer_function is not None:
                yield validation_problem("force_law", "has applied forces on a transfer function", "Give a mean force.")
                return
            yield from self._find_wrong_point("force_law.aerodynamic_force.on", self.force_law.aerodynamic_force.on)

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the model without the structure of its head."""
        if self.chain is not None:
            return len(self.chain.masses_kg)
        if self.transfer_function is not None:
            return self.transfer_function.unknowns
        return len(self.matrices.head if self.matrices is not None else self.modes.head_shape if self.modes else ())

    @property
    def strips(self) -> int:
        """Number of strips."""
        return max(len(self.head.strip), 1) if self.head is not None else 1

    def rigid_motion(self, size: int) -> RealArray:
        """Displacement of the unknowns of a chain and its head when all masses rise by one, (size,)."""
        rigid = np.zeros(size)
        rigid[: self.unknowns] = 1.0
        if self.head is not None:
            first = self.unknowns + (self.head.pitch is not None)
            rigid[first : first + sum(strip.mass_kg is not None for strip in self.head.strip)] = 1.0
        return rigid

    @property
    def has_joints(self) -> bool:
        """Whether friction or stops act."""
        return self.head is not None and bool(self.head.friction or self.head.stop)

    @property
    def follows_stagger(self) -> bool:
        """Whether the motion of a strip depends on the lateral position of the wire."""
        head = self.head
        if head is None:
            return False
        return head.roll is not None or any(len(shape) > 1 for mode in head.bending_mode for shape in mode.shapes)

    def penetration(self, force: Force) -> Force:
        """Penetration of the strips and the wire under a contact force that they share [m, N]."""
        return self.contact.penetration(force / self.strips)

    def compliance(self, force: float) -> float:
        """Change of this penetration with the contact force, at a force [m/N, N]."""
        return self.contact.compliance(force / self.strips) / self.strips

    @cross_check
    def _head_fits_the_model(self) -> Problems:
        if self.head is None:
            return
        if self.transfer_function is not None:
            yield validation_problem("head", "found beside a transfer function", "A receptance has one rigid strip.")
            return
        for problem in self.head.find_misfits(self.chain is not None, self.unknowns):
            yield _place_problem("head", problem)
        if self.chain is None:
            return
        known = ("base", *(f"strip {n}" for n, _ in enumerate(self.head.strip, 1)))
        for key in ("friction", "stop"):
            for i, table in enumerate(getattr(self.head, key)):
                place, parts = f"head.{key}[{i}].between", table.between or ()
                masses = [part for part in parts if part not in known]
                wrong = [problem for mass in masses for problem in self.chain.find_wrong_mass(place, mass, known)]
                yield from wrong
                if not wrong and len({part if part in known else self.chain.mass_index(part) for part in parts}) == 1:
                    yield validation_problem(place, "names one part twice", "Give two parts.")

    def _find_wrong_point(self, key: str, point: int | str | tuple[float, ...]) -> Problems:
        """Problem of a point of application that does not have the form of the model."""
        if self.chain is not None:
            if isinstance(point, tuple):
                yield validation_problem(key, "found a list", "Give the mass of the chain, by number or name.")
            else:
                yield from self.chain.find_wrong_mass(key, point)
            return
        if not isinstance(point, tuple) or len(point) != self.unknowns:
            yield validation_problem(
                key, f"is not a list of {self.unknowns} values", "Give the displacement of the point in each unknown."
            )


def _place_problem(table: str, problem: PydanticCustomError) -> PydanticCustomError:
    """Problem of a key of a table, as a problem of the file."""
    context = problem.context or {}
    return validation_problem(f"{table}.{context['key']}", context["found"], context["hint"])


def _find_wrong_lengths(table: InputTable, keys: tuple[str, ...], n: int, item: str, items: str) -> Problems:
    for key in keys:
        if (values := getattr(table, key)) is not None and len(values) != n:
            yield validation_problem(key, f"{len(values)} values for {n} {items}", f"Give one value per {item}.")
