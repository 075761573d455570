"""Pantograph of the reference simulator from a pantograph file."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.force_law import AppliedForceLaw
from pantocheck.conformance.pantograph.pantograph_file import ChainTable, PantographFile
from pantocheck.conformance.pantograph.transfer_function import TransferFunctionTable
from pantocheck.model.description.pantograph import (
    Pantograph,
    build_chain,
    from_matrices,
    from_modes,
    from_poles,
    preload_springs,
)


def build_pantograph(
    file: PantographFile,
    uplift_force: float,
    working_height: float,
    wire_height: float = 0.0,
    aerodynamic_force: float = 0.0,
) -> Pantograph:
    """Pantograph with an uplift force and a static working height.

    One convention holds for chains, matrices and modes: displacements count from the static working height of the
    head, and with all of them zero every spring is without force. The base spring of a chain whose uplift force acts
    below the head therefore carries a part of it: the frame is above that datum, as the springs over it are compressed.

    Args:
        file: Content of the pantograph file.
        uplift_force: Uplift force [N].
        working_height: Static height of the head under this force [m].
        wire_height: Nominal height of the contact wire [m].
        aerodynamic_force: Part of the uplift force that acts at the point of the aerodynamic force [N].
    """
    model = _build_model(file, uplift_force, working_height, wire_height)
    shift = _aerodynamic_point(file) - _uplift_point(file)
    model = replace(
        model,
        force=model.force + aerodynamic_force * shift,
        contact_damping=file.contact.damping_N_s_m,
        hertz_coefficient=file.contact.hertz_coefficient,
    )
    if file.head is None:
        return model
    return file.head.extend(model, partial(_find_part, file), _datum(file, model.head, working_height, wire_height))


def _datum(file: PantographFile, head: RealArray, working_height: float, wire_height: float) -> RealArray:
    """Displacement of the unknowns at which the springs are without force."""
    if file.chain is not None:
        at_working_height = file.chain.base_spring_unstretched == "working_height"
        return np.full(head.size, working_height if at_working_height else wire_height)
    shapes = [strip.shape for strip in file.head.strip if strip.shape] if file.head is not None else []
    if shapes:
        return np.asarray(np.linalg.pinv(np.array(shapes)) @ np.full(len(shapes), working_height))
    # Any displacement with the head at the working height is suitable: its spring forces become preload.
    return np.asarray(head * working_height / (head @ head))


def _find_part(file: PantographFile, part: int | str, size: int) -> RealArray:
    """Displacement of the base or of a mass of a chain, per unit of each of the unknowns."""
    place = np.zeros(size)
    if part != "base" and file.chain is not None:
        place[file.chain.mass_index(part)] = 1.0
    return place


def _build_model(file: PantographFile, uplift_force: float, working_height: float, wire_height: float) -> Pantograph:
    """Pantograph whose whole uplift force acts at one point."""
    contact = file.contact.stiffness_N_m or math.inf
    if file.chain is not None:
        parts = file.chain
        model = build_chain(
            np.array(parts.masses_kg),
            np.array(parts.stiffness_N_m),
            np.array(parts.damping_N_s_m),
            uplift_force,
            parts.uplift_mass,
            contact,
        )
        return preload_springs(model, _datum(file, model.head, working_height, wire_height))
    if file.matrices is not None:
        table = file.matrices
        matrices = (np.array(table.mass_kg), np.array(table.damping_N_s_m), np.array(table.stiffness_N_m))
        model = from_matrices(*matrices, np.array(table.head), uplift_force, contact)
        model = replace(model, force=uplift_force * _uplift_point(file))
        return preload_springs(model, _datum(file, model.head, working_height, wire_height))
    modes = file.modes
    if modes is None:
        function = _transfer_function(file)
        model = from_poles(function.pole, function.residue, uplift_force, contact)
        model = replace(model, force=uplift_force * function.uplift_factor * model.head)
        return preload_springs(model, _datum(file, model.head, working_height, wire_height))
    omega, shape = 2 * np.pi * np.array(modes.frequency_Hz), np.array(modes.head_shape)
    preload = omega**2 * _datum(file, shape, working_height, wire_height)
    force = uplift_force * _uplift_point(file) + preload
    return from_modes(np.array(modes.frequency_Hz), np.array(modes.damping_ratio), shape, force, uplift_force, contact)


def _uplift_point(file: PantographFile) -> RealArray:
    """Displacement of the point of the uplift force per unit of each unknown."""
    if file.chain is not None:
        return _choose_mass(file.chain, file.chain.uplift_force_on)
    if file.matrices is not None:
        return np.array(file.matrices.uplift_force_on or file.matrices.head)
    if file.modes is not None:
        return np.array(file.modes.uplift_force_on or file.modes.head_shape)
    return np.zeros(_transfer_function(file).unknowns)


def _transfer_function(file: PantographFile) -> TransferFunctionTable:
    if file.transfer_function is None:
        raise ValueError("a pantograph without a model")  # No valid file has this content.
    return file.transfer_function


def _aerodynamic_point(file: PantographFile) -> RealArray:
    """Displacement of the point of the aerodynamic force per unit of each unknown; without a law as `_uplift_point`."""
    if not isinstance(file.force_law, AppliedForceLaw):
        return _uplift_point(file)
    point = file.force_law.aerodynamic_force.on
    if isinstance(point, tuple):
        return np.array(point)
    if file.chain is None:
        raise ValueError("a mass of a pantograph without masses")  # No valid file has this content.
    return _choose_mass(file.chain, point)


def _choose_mass(chain_table: ChainTable, mass: int | str) -> RealArray:
    """Unit displacement of one mass of a chain."""
    return np.asarray(np.eye(len(chain_table.masses_kg))[chain_table.mass_index(mass)])


# Receptance of the head of a pantograph: its motion under a harmonic contact force.
def head_receptance(file: PantographFile, omega: RealArray) -> NDArray[np.complex128]:
    """Displacement of the head over a force on it, e_h (K + i w C - w^2 M)^-1 e_h, (n,) [m/N], at omega [rad/s]."""
    model, w = build_pantograph(file, 0.0, 0.0), omega[:, None, None]
    dynamic = model.stiffness + 1j * w * model.damping - w**2 * model.mass
    motion = np.linalg.solve(dynamic, model.head.astype(complex)[:, None])[..., 0]
    return np.asarray(motion @ model.head, dtype=np.complex128)
