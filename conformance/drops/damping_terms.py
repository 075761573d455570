"""Terms of piecewise Rayleigh damping: one coefficient per kind of component and matrix.

With C = sum over kinds e of a_e K_e + b_e M_e, a mass-normalised mode phi_j has the damping ratio

    zeta_j = sum_e (a_e k_ej + b_e m_ej) / (2 w_j),    k_ej = phi_j' K_e phi_j,   m_ej = phi_j' M_e phi_j
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.model import Catenary, Kind, Rayleigh
from pantocheck.model.modal.modes import ComponentEnergies

Term = tuple[str, str]
"""Kind of component, and name of the matrix of the coefficient."""


@dataclass(frozen=True)
class DampingMatrix:
    """Matrix of a Rayleigh coefficient: key in a line file, unit, and plausible value of the coefficient."""

    key: str
    unit: str
    plausible: float


MATRICES = {
    "stiffness": DampingMatrix("stiffness_coefficient_s", "s", 1e-4),
    "mass": DampingMatrix("mass_coefficient_1_s", "1/s", 0.1),
}
"""Matrices by name, in the order of the terms; plausible values are the largest in Vo Van, Balmes, Lorang 2015."""

TABLE_OF_KIND = {
    Kind.CONTACT_WIRE: "contact_wire",
    Kind.MESSENGER_WIRE: "messenger_wire",
    Kind.STITCH_WIRE: "stitch_wire",
    Kind.DROPPER: "droppers",
    Kind.STEADY_ARM: "steady_arms",
    Kind.MESSENGER_SUPPORT: "messenger_supports",
}
"""Table of a kind of component in the damping of a line file."""


WIRES: tuple[str, ...] = (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE)
"""Kinds of component that are fitted."""

JOINED_WIRES = "wires"
"""Name of the wires with common coefficients."""


def list_other_damping(line: Catenary) -> dict[Kind, Rayleigh]:
    """Rayleigh damping that a line states for the components that are not fitted."""
    return {kind: line.rayleigh(kind) for kind in Kind if kind not in WIRES}


@dataclass(frozen=True)
class DampingBasis:
    """Damping ratios of the modes per unit of each coefficient."""

    terms: tuple[Term, ...]
    """Kind and matrix of each of the t coefficients."""
    ratios: RealArray
    """Damping ratio per unit of the coefficient [1/s] for stiffness, [s] for mass, (m, t)."""
    stated: RealArray
    """Damping ratio by the components that are not fitted, whose damping the line states, (m,) [-]."""

    def select_modes(self, modes: IntegerArray) -> "DampingBasis":
        """Basis of selected modes, by index."""
        return DampingBasis(self.terms, self.ratios[modes], self.stated[modes])

    def predict(self, values: Mapping[Term, float]) -> RealArray:
        """Damping ratios for coefficients by term, (m,); a coefficient that is not named is 0."""
        return np.asarray(self.stated + self.ratios @ np.array([values.get(term, 0.0) for term in self.terms]))

    def join_wires(self) -> "DampingBasis":
        """Basis in which the wires of `WIRES` share their coefficients, as terms of the kind `JOINED_WIRES`."""
        others = [i for i, (kind, _) in enumerate(self.terms) if kind not in WIRES]
        shared = [
            self.ratios[:, [self.terms.index((wire, matrix)) for wire in WIRES]].sum(axis=1) for matrix in MATRICES
        ]
        terms = (*((JOINED_WIRES, matrix) for matrix in MATRICES), *(self.terms[i] for i in others))
        return DampingBasis(terms, np.column_stack([*shared, self.ratios[:, others]]), self.stated)


def build_damping_basis(frequency: RealArray, energies: ComponentEnergies, stated: RealArray) -> DampingBasis:
    """Build the basis from the frequencies [Hz], the energies and the stated damping ratios of the modes."""
    terms = tuple((str(kind), matrix) for kind in energies.kinds for matrix in MATRICES)
    both = np.stack([energies.stiffness, energies.mass], axis=2).reshape(frequency.size, -1)
    return DampingBasis(terms, np.asarray(both / (4 * np.pi * frequency[:, None])), stated)
