"""Pantograph of the reference simulator from a pantograph file."""

import numpy as np

from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.model.pantograph import Pantograph, chain, from_matrices, from_modes, preload_springs


def build_pantograph(file: PantographFile, uplift_force: float, working_height: float) -> Pantograph:
    """A pantograph pressing with an uplift force.

    Parameters
    ----------
    file : PantographFile
        As read.
    uplift_force : float
        [N].
    working_height : float
        Of the head over the contact wire at the supports, at rest and pressing with that force [m].

    Returns
    -------
    Pantograph
        The pantograph in the simulator's terms.
    """
    contact = file.contact.stiffness_N_m
    if file.chain is not None:
        parts = file.chain
        model = chain(
            np.array(parts.masses_kg),
            np.array(parts.stiffness_N_m),
            np.array(parts.damping_N_s_m),
            uplift_force,
            parts.uplift_mass,
            contact,
        )
        unstretched = working_height if parts.base_spring_unstretched == "working_height" else 0.0
        return preload_springs(model, np.full(len(parts.masses_kg), unstretched))
    if file.matrices is not None:
        given = file.matrices
        matrices = (np.array(given.mass_kg), np.array(given.damping_N_s_m), np.array(given.stiffness_N_m))
        model = from_matrices(*matrices, np.array(given.head), uplift_force, contact)
        # Any unknowns with the head at the working height are suitable: the spring forces there become preload.
        return preload_springs(model, model.head * working_height / (model.head @ model.head))
    modes = file.modes
    if modes is None:
        raise ValueError("a pantograph without a model")  # which no file passes as
    omega, shape = 2 * np.pi * np.array(modes.frequency_Hz), np.array(modes.head_shape)
    preload = omega**2 * shape * working_height / (shape @ shape)
    force = uplift_force * shape + preload
    return from_modes(np.array(modes.frequency_Hz), np.array(modes.damping_ratio), shape, force, uplift_force, contact)
