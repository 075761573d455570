"""scikit-fem: natural frequencies of a line from its own assembly of finer elements."""

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import Catenary, DiscretisedLine, Wire, discretise
from pantocheck.model.modal.modes import compute_modes
from verification.guide.comparisons import compare_relative
from verification.guide.guide_format import CheckedValue
from verification.guide.topics.bare_wires import build_short_line

ELEMENT_M, REFINEMENTS = 0.5, 3
"""Element length of the line, and number of times that scikit-fem halves it."""

COMPARED_MODES = 30
FREQUENCY_TOLERANCE = 3e-5
"""Largest relative difference: measured 2.3e-5 where the wires vibrate against each other through the droppers."""


def compare_frequencies() -> list[CheckedValue]:
    """Natural frequencies of a line of three spans beside those of scikit-fem."""
    catenary = build_short_line(3)
    line = discretise(catenary, ELEMENT_M)
    ours, theirs = compute_modes(line, COMPARED_MODES).frequency, solve_with_scikit_fem(catenary, line)
    worst = int(np.argmax(np.abs(ours / theirs - 1)))
    return [
        compare_relative(
            name,
            f"frequency of mode {mode + 1}{words}",
            "Hz",
            (ours[mode], theirs[mode]),
            FREQUENCY_TOLERANCE,
            "Elements of 0.5 m with residual flexibility against elements of an eighth without.",
        )
        for name, mode, words in (
            ("first", 0, ""),
            ("last", COMPARED_MODES - 1, ""),
            ("worst", worst, f", the largest difference of {COMPARED_MODES}"),
        )
    ]


def solve_with_scikit_fem(catenary: Catenary, line: DiscretisedLine) -> RealArray:
    """Natural frequencies of the vertical motion of a line [Hz]; springs of connectors are added by hand.

    Args:
        catenary: Contact wire and messenger wire with droppers of given stiffness.
        line: Its elements, which are refined.
    """
    from skfem import Basis, ElementLineHermite, MeshLine

    wires = [_assemble_wire(catenary.wire(name), line.mesh.position) for name in ("contact", "messenger")]
    basis = Basis(MeshLine(line.mesh.position).refined(REFINEMENTS), ElementLineHermite())
    stiffness = sp.lil_matrix(sp.block_diag([wire[0] for wire in wires]))
    mass = sp.csc_matrix(sp.block_diag([wire[1] for wire in wires]))
    size = wires[0][0].shape[0]

    def unknown(wire: int, x: float) -> int:
        node = int(np.argmin(np.abs(basis.mesh.p[0] - x)))
        first: int = wire * size
        return first + int(basis.nodal_dofs[0, node])

    def add_spring(ends: list[int], k: float) -> None:
        for sign, i in zip((1, -1), ends, strict=False):
            for other, j in zip((1, -1), ends, strict=False):
                stiffness[i, j] += sign * other * k

    for dropper in catenary.droppers:
        add_spring([unknown(0, dropper.position), unknown(1, dropper.position)], dropper.stiffness or 0.0)
    for arm in catenary.steady_arms:
        add_spring([unknown(0, arm.position)], arm.vertical_stiffness or 0.0)
    for support in catenary.messenger_supports:
        add_spring([unknown(1, support.position)], support.stiffness)
    end = catenary.wires[0].end
    ends = [unknown(wire, x) for wire in (0, 1) for x in (0.0, end)]
    free = np.setdiff1d(np.arange(stiffness.shape[0]), ends)
    squares = eigsh(
        sp.csc_matrix(stiffness)[free][:, free], COMPARED_MODES, mass[free][:, free], sigma=0.0,
        return_eigenvectors=False, v0=np.ones(free.size),
    )  # fmt: skip
    return np.asarray(np.sqrt(np.sort(squares)) / (2 * np.pi))


def _assemble_wire(wire: Wire, stations: RealArray) -> tuple[Any, Any]:
    """Stiffness and mass of a wire by scikit-fem."""
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import d, dd

    basis = Basis(MeshLine(stations).refined(REFINEMENTS), ElementLineHermite())

    @BilinearForm
    def stiffness(u: Any, v: Any, w: Any) -> Any:
        return wire.bending_stiffness * dd(u)[0][0] * dd(v)[0][0] + wire.tension * d(u)[0] * d(v)[0]

    @BilinearForm
    def mass(u: Any, v: Any, w: Any) -> Any:
        return wire.mass_per_length * u * v

    return stiffness.assemble(basis), mass.assemble(basis)
