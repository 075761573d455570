"""Distributed forces in a time step: compliances of stretches, modes and connectors against full matrices."""

from dataclasses import replace

import numpy as np

from helpers.effective_inverse import inverse_of_assembled
from helpers.lines import fix_along_track, simple_line
from pantocheck.model import Kind, ModalBand, Rayleigh, discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.modal.modal_damping import build_modal_terms

TIME_STEP = 2e-3


def test_compliances_are_those_of_the_assembled_inverse() -> None:
    """G A^-1 G' with a column of G per connector, stretch and mode; responses are cut at 1e-12 of their peaks."""
    damping = dict.fromkeys(Kind, Rayleigh(0.05, 1e-4))
    catenary = fix_along_track(simple_line(3, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0), damping))
    line = discretise(replace(catenary, modal_damping=(ModalBand(0.8, 2.0, 0.02),)), 2.0)
    kernel, terms, stretches = build_kernel_arrays(line, TIME_STEP), build_modal_terms(line), line.stretches
    connectors = line.connectors
    directions = np.zeros((kernel.forces.settling.size, *line.beams.free.shape))
    for n, station in enumerate(connectors.station):
        directions[n, :, station, 0] = connectors.coefficient[n]
    first = connectors.station.size
    for k in range(stretches.stiffness.size):
        inside = slice(stretches.first[k], stretches.first[k] + stretches.coefficient.shape[2])
        part = directions[first + k, stretches.row[k], inside]
        directions[first + k, stretches.row[k], inside] = stretches.coefficient[k, :, : part.shape[1]]
    directions[first + stretches.stiffness.size :] = terms.weight
    assert stretches.stiffness.size >= 2
    assert terms.damping.size >= 2
    flat = directions.reshape(len(directions), -1)
    expected = flat @ inverse_of_assembled(line, TIME_STEP).reshape(flat.shape[1], -1) @ flat.T
    computed = np.zeros_like(expected)
    for n in range(len(flat)):
        pairs = slice(kernel.forces.first[n], kernel.forces.first[n + 1])
        computed[n, kernel.forces.other[pairs]] = kernel.forces.compliance[pairs]
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(computed / np.outer(scale, scale), expected / np.outer(scale, scale), rtol=0, atol=1e-10)
