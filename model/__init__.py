"""Reference simulator: mechanics only, without standards, file formats or reports.

Every public name is loaded on first use: a program that only describes a line does not wait for scipy or numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pantocheck.model.catenary import (
        Catenary,
        Clamp,
        Dropper,
        Kind,
        MessengerSupport,
        ModalBand,
        PointMass,
        Rayleigh,
        SectionChange,
        SteadyArm,
        TensionChange,
        Wire,
    )
    from pantocheck.model.curves import TrackCurve
    from pantocheck.model.discretised_line import DiscretisedLine, discretise, make_droppers_bilateral
    from pantocheck.model.dynamics.passage import History, Passage
    from pantocheck.model.dynamics.simulation import simulate_passage
    from pantocheck.model.failures import SimulationError
    from pantocheck.model.irregularity import Irregularity, SpectralDensity, realise_irregularity
    from pantocheck.model.pantograph import Pantograph, chain

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
    "Pantograph",
    "Passage",
    "PointMass",
    "Rayleigh",
    "SectionChange",
    "SimulationError",
    "SpectralDensity",
    "SteadyArm",
    "TensionChange",
    "TrackCurve",
    "Wire",
    "chain",
    "discretise",
    "make_droppers_bilateral",
    "realise_irregularity",
    "simulate_passage",
]

_MODULES = {
    "TrackCurve": "curves",
    "DiscretisedLine": "discretised_line",
    "History": "dynamics.passage",
    "Irregularity": "irregularity",
    "Pantograph": "pantograph",
    "Passage": "dynamics.passage",
    "SimulationError": "failures",
    "SpectralDensity": "irregularity",
    "chain": "pantograph",
    "discretise": "discretised_line",
    "make_droppers_bilateral": "discretised_line",
    "realise_irregularity": "irregularity",
    "simulate_passage": "dynamics.simulation",
}
"""Modules of the public names that are not defined in `catenary`."""


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name not in __all__:
        raise AttributeError(f"module 'pantocheck.model' has no attribute {name!r}")
    return getattr(import_module(f"pantocheck.model.{_MODULES.get(name, 'catenary')}"), name)
