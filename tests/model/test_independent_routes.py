"""Simulator against independent formulations that share only the line with it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from helpers.central_differences import contact_force
from helpers.lines import PANTOGRAPH_2002, Array, simple_line
from pantocheck.model import Kind, Passage, Rayleigh, Wire, discretise, simulate_passage
from pantocheck.model.modal.modes import compute_modes
from pantocheck.model.pantograph import preload_springs

PANTOGRAPH = preload_springs(PANTOGRAPH_2002, np.full(2, 0.06))
RATE = 500.0
BANDS = ((0.0, 5.0), (5.0, 20.0), (20.0, 50.0))


def band_rms(force: Array) -> list[float]:
    """Root mean square in each band [N]."""
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, 1 / RATE)
    return [float(np.sqrt(power[(frequency > low) & (frequency <= high)].sum())) for low, high in BANDS]


def test_passage_and_explicit_integration_agree_in_every_band() -> None:
    """Central differences at 0.2 ms, with a second-order error far below 1 %; the kernel at 0.25 ms."""
    damping = {kind: Rayleigh(0.0125, 1e-4) for kind in Kind}
    line = discretise(simple_line(3, damping=damping), 0.5)
    explicit = Passage((PANTOGRAPH,), (60.0,), 250 / 3.6, 1.1, 2e-4)
    explicit_force = contact_force(line, explicit)[:: round(1 / (RATE * 2e-4))]
    kernel_force = simulate_passage(line, replace(explicit, time_step=2.5e-4)).force[0][:: round(1 / (RATE * 2.5e-4))]
    settled = slice(round(0.1 * RATE), None)
    assert band_rms(kernel_force[settled]) == pytest.approx(band_rms(explicit_force[settled]), rel=0.01)
    assert np.abs(kernel_force[settled]).max() == pytest.approx(np.abs(explicit_force[settled]).max(), rel=0.01)


def test_modes_agree_with_fine_elements_of_scikit_fem_on_a_whole_line() -> None:
    """scikit-fem assembles the same two beams with an eighth of the element length; springs are added by hand.

    With the residual flexibility the elements of 0.5 m agree within 2.3e-5, and without it within 3.7e-3. Both occur at
    9.2 Hz, where the wires vibrate against each other through the droppers.
    """
    skfem = pytest.importorskip("skfem", reason="scikit-fem comes with the extra 'peers'")
    from skfem.helpers import d, dd

    catenary = simple_line(3)
    line = discretise(catenary, 0.5)
    blocks = []
    for name in ("contact", "messenger"):
        wire = catenary.wire(name)
        mesh = skfem.MeshLine(line.mesh.position).refined(3)
        basis = skfem.Basis(mesh, skfem.ElementLineHermite())

        @skfem.BilinearForm
        def stiffness(u: Any, v: Any, w: Any, wire: Wire = wire) -> Any:
            return wire.bending_stiffness * dd(u)[0][0] * dd(v)[0][0] + wire.tension * d(u)[0] * d(v)[0]

        @skfem.BilinearForm
        def mass(u: Any, v: Any, w: Any, wire: Wire = wire) -> Any:
            return wire.mass_per_length * u * v

        blocks.append((stiffness.assemble(basis).tolil(), mass.assemble(basis).tolil(), basis))
    K = sp.lil_matrix(sp.block_diag([block[0] for block in blocks]))
    M = sp.csc_matrix(sp.block_diag([block[1] for block in blocks]))
    size = blocks[0][0].shape[0]

    def dof(wire: int, x: float) -> int:
        basis = blocks[wire][2]
        node = int(np.argmin(np.abs(basis.mesh.p[0] - x)))
        return wire * size + int(basis.nodal_dofs[0, node])

    def add_spring(lower: int, upper: int | None, k: float) -> None:
        K[lower, lower] += k
        if upper is not None:
            K[upper, upper] += k
            K[lower, upper] -= k
            K[upper, lower] -= k

    for dropper in catenary.droppers:
        add_spring(dof(0, dropper.position), dof(1, dropper.position), dropper.stiffness or 0.0)
    for arm in catenary.steady_arms:
        add_spring(dof(0, arm.position), None, arm.vertical_stiffness or 0.0)
    for support in catenary.messenger_supports:
        add_spring(dof(1, support.position), None, support.stiffness)
    ends = [dof(wire, x) for wire in (0, 1) for x in (0.0, 180.0)]
    keep = np.setdiff1d(np.arange(K.shape[0]), ends)
    reduced = sp.csc_matrix(K)[keep][:, keep]
    w2 = np.sort(eigsh(reduced, 30, M[keep][:, keep], sigma=0.0, return_eigenvectors=False))
    assert compute_modes(line, 30).frequency == pytest.approx(np.sqrt(w2) / (2 * np.pi), rel=3e-5)
