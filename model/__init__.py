"""Reference simulator: mechanics only, without standards, file formats or reports.

Every public name is loaded on first use: a program that only describes a line does not wait for scipy or numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pantocheck.model.description.catenary import (
        Catenary,
        Clamp,
        Dropper,
        Kind,
        MessengerSupport,
        ModalBand,
        PointMass,
        Rayleigh,
        SectionChange,
        Spring,
        SteadyArm,
        TensionChange,
        Wire,
    )
    from pantocheck.model.description.curves import TrackCurve
    from pantocheck.model.description.failures import SimulationError
    from pantocheck.model.description.irregularity import Irregularity, SpectralDensity, realise_irregularity
    from pantocheck.model.description.pantograph import Pantograph, build_chain
    from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise, make_droppers_bilateral
    from pantocheck.model.dynamics.passage import History, Passage
    from pantocheck.model.dynamics.simulation import simulate_passage
    from pantocheck.model.fem.beam import wave_speed
    from pantocheck.model.modal.modes import Modes, compute_modes, damping_ratios
    from pantocheck.model.statics.elasticity import rest_height, static_uplift
    from pantocheck.model.statics.wave_factors import doppler_factor, reflection_coefficient

__all__ = [
    "Catenary",
    "Clamp",
    "DiscretisedLine",
    "Dropper",
    "History",
    "Irregularity",
    "Kind",
    "MessengerSupport",
    "ModalBand",
    "Modes",
    "Pantograph",
    "Passage",
    "PointMass",
    "Rayleigh",
    "SectionChange",
    "SimulationError",
    "SpectralDensity",
    "Spring",
    "SteadyArm",
    "TensionChange",
    "TrackCurve",
    "Wire",
    "build_chain",
    "compute_modes",
    "damping_ratios",
    "discretise",
    "doppler_factor",
    "make_droppers_bilateral",
    "realise_irregularity",
    "reflection_coefficient",
    "rest_height",
    "simulate_passage",
    "static_uplift",
    "wave_speed",
]

_MODULES = {
    "TrackCurve": "description.curves",
    "DiscretisedLine": "discretisation.discretised_line",
    "History": "dynamics.passage",
    "Irregularity": "description.irregularity",
    "Pantograph": "description.pantograph",
    "Modes": "modal.modes",
    "Passage": "dynamics.passage",
    "SimulationError": "description.failures",
    "SpectralDensity": "description.irregularity",
    "build_chain": "description.pantograph",
    "compute_modes": "modal.modes",
    "damping_ratios": "modal.modes",
    "discretise": "discretisation.discretised_line",
    "doppler_factor": "statics.wave_factors",
    "make_droppers_bilateral": "discretisation.discretised_line",
    "realise_irregularity": "description.irregularity",
    "reflection_coefficient": "statics.wave_factors",
    "rest_height": "statics.elasticity",
    "simulate_passage": "dynamics.simulation",
    "static_uplift": "statics.elasticity",
    "wave_speed": "fem.beam",
}
"""Modules of the public names that are not defined in `catenary`."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name not in __all__:
        raise AttributeError(f"module 'pantocheck.model' has no attribute {name!r}")
    try:
        module = import_module(f"pantocheck.model.{_MODULES.get(name, 'description.catenary')}")
    except ModuleNotFoundError as error:
        error.add_note("The compiled simulations need an extra: pip install 'pantocheck[simulator]'")
        raise
    return getattr(module, name)
