"""Modal damping: selected modes have their damping ratios, the others their Rayleigh damping."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from helpers.lines import Array, complex_roots, simple_line
from pantocheck.model import DiscretisedLine, Kind, ModalBand, Rayleigh, discretise
from pantocheck.model.description.failures import NegativeDamping
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import build_motion, end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.modal import modal_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands, build_modal_terms
from pantocheck.model.modal.modes import compute_modes, damping_ratios
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass

UNIFORM = dict.fromkeys(Kind, Rayleigh(0.05, 1e-4))
BAND = ModalBand(0.8, 1.5, 0.02)


def damped_line() -> DiscretisedLine:
    """Two spans with uniform Rayleigh damping, the modes between 0.8 and 1.5 Hz set to 2 %."""
    return discretise(replace(simple_line(damping=UNIFORM), modal_damping=(BAND,)), 2.0)


def full_damping(line: DiscretisedLine) -> Array:
    """Damping matrix that the simulator never forms."""
    matrices, terms = assemble_matrices(line), build_modal_terms(line)
    weight = terms.weight.reshape(len(terms.damping), -1)[:, bandwidth_order(line)[matrices.free]]
    return np.asarray(matrices.damping.toarray() + weight.T @ np.diag(terms.damping) @ weight)


def test_complex_eigenvalues_have_the_modal_ratios_and_rayleigh_ratios_elsewhere() -> None:
    """Uniform Rayleigh damping couples no modes, so both hold exactly; dense eigenvalues carry about ten digits."""
    line = damped_line()
    modes = compute_modes(line, 12)
    expected = damping_ratios(line, modes)
    chosen = (modes.frequency >= BAND.from_frequency) & (modes.frequency < BAND.to_frequency)
    assert 1 < chosen.sum() < 6
    expected[chosen] = BAND.damping_ratio
    matrices = assemble_matrices(line)
    roots = complex_roots(matrices.mass.toarray(), full_damping(line), matrices.stiffness.toarray(), 12)
    np.testing.assert_allclose(-roots.real / np.abs(roots), expected, rtol=1e-5)


def test_ratios_hold_to_first_order_where_components_have_other_coefficients() -> None:
    """Damping of the messenger alone couples the modes: a tenth of all damping leaves a hundredth of the error."""
    errors = []
    for share in (1.0, 0.1):
        damping = dict.fromkeys(Kind, Rayleigh()) | {Kind.MESSENGER_WIRE: Rayleigh(0.3 * share, 1e-3 * share)}
        band = replace(BAND, damping_ratio=0.02 * share)
        line = discretise(replace(simple_line(damping=damping), modal_damping=(band,)), 4.0)
        matrices, modes = assemble_matrices(line), compute_modes(line, 12)
        expected = apply_modal_bands(damping_ratios(line, modes), modes.frequency, (band,))
        roots = complex_roots(matrices.mass.toarray(), full_damping(line), matrices.stiffness.toarray(), 12)
        errors.append(np.abs(-roots.real / np.abs(roots) / expected - 1).max())
    assert errors[0] > 1e-5
    assert errors[1] < 0.02 * errors[0]


def test_damping_matrix_that_would_be_negative_is_refused() -> None:
    """A messenger that is damped alone, and a mode of both wires without damping: -0.08 1/s with the full matrix."""
    damping = dict.fromkeys(Kind, Rayleigh()) | {Kind.MESSENGER_WIRE: Rayleigh(0.3, 1e-3)}
    line = simple_line(damping=damping)
    undamped = discretise(replace(line, modal_damping=(replace(BAND, damping_ratio=0.0),)), 4.0)
    with pytest.raises(NegativeDamping, match="some motion would grow"):
        build_modal_terms(undamped)
    kept = discretise(replace(line, modal_damping=(replace(BAND, damping_ratio=0.02),)), 4.0)
    assert (build_modal_terms(kept).damping > 0).all()
    assert eigh(full_damping(kept), assemble_matrices(kept).mass.toarray(), eigvals_only=True)[0] > -1e-9
    uniform = replace(simple_line(damping=UNIFORM), modal_damping=(replace(BAND, damping_ratio=1e-4),))
    lowered = discretise(uniform, 4.0)
    assert (build_modal_terms(lowered).damping < 0).all()
    assert eigh(full_damping(lowered), assemble_matrices(lowered).mass.toarray(), eigvals_only=True)[0] > 0


def test_band_includes_its_lower_and_not_its_upper_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bands whose edges are the frequencies of modes; every band has another ratio, as Rayleigh damping has.

    Both sides take the same modes: the last digit of a frequency depends on the number of modes.
    """
    plain = discretise(simple_line(damping=UNIFORM), 2.0)
    modes = compute_modes(plain, 16)
    monkeypatch.setattr(modal_damping, "compute_modes_below", lambda *_: modes)
    frequency, rayleigh = modes.frequency[:6], damping_ratios(plain, modes)[:6]
    bands = tuple(ModalBand(float(frequency[i]), float(frequency[i + 2]), ratio) for i, ratio in ((1, 0.02), (3, 0.03)))
    terms = build_modal_terms(replace(plain, catenary=replace(plain.catenary, modal_damping=bands)))
    ratios = np.array([0.02, 0.02, 0.03, 0.03])
    added = 4 * np.pi * frequency[1:5] * (ratios - rayleigh[1:5])
    np.testing.assert_allclose(terms.damping, added, rtol=1e-6)
    assert build_modal_terms(plain).damping.size == 0
    expected = [rayleigh[0], *ratios, rayleigh[5]]
    np.testing.assert_allclose(apply_modal_bands(rayleigh, frequency, bands), expected, rtol=1e-12)


def test_step_with_modal_damping_equals_the_full_matrix() -> None:
    """300 steps from a deflected state against average acceleration with dense matrices; droppers stay taut.

    The forces of a step settle to 1e-9 N of about 100 N, and 300 steps accumulate the rest: 1e-8 of the motion.
    """
    line, dt = damped_line(), 2e-3
    matrices, damping = assemble_matrices(line), full_damping(line)
    mass, stiffness = correct_mass(line, dt).toarray(), matrices.stiffness.toarray()
    place = bandwidth_order(line)[matrices.free]
    start = np.zeros(line.beams.free.size)
    start[place] = 1e-4 * np.linalg.solve(stiffness, mass @ np.ones(matrices.free.size))
    q, v = start[place], np.zeros(matrices.free.size)
    a = np.linalg.solve(mass, -stiffness @ q)
    spread = np.zeros((3, line.beams.free.size))
    spread[0, place], spread[2, place] = q, a
    w, r = (spread.reshape(3, *line.beams.free.shape)[..., i] for i in range(2))
    kernel = build_kernel_arrays(line, dt)
    tension = line.connectors.preload + line.connectors.stiffness * np.einsum(
        "nb,nb->n", line.connectors.coefficient, w[0].T[line.connectors.station]
    )
    motion = build_motion(kernel.layout, dt, (w, r), np.append(tension, np.zeros(kernel.distributed.number)))
    train = build_empty_train(1)
    work = build_workspace(kernel, train)
    effective = mass + dt / 2 * damping + dt**2 / 4 * stiffness
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(300):
        assert advance() > 0
        predicted, rate = q + dt * v + dt**2 / 4 * a, v + dt / 2 * a
        a = np.linalg.solve(effective, -stiffness @ predicted - damping @ rate)
        q, v = predicted + dt**2 / 4 * a, rate + dt / 2 * a
    w, r = end_of_step(motion, kernel.layout, dt)
    flat = np.stack([w[0], r[0]], axis=-1).ravel()[place]
    np.testing.assert_allclose(flat, q, rtol=0, atol=1e-8 * np.abs(q).max())
