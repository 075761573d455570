"""The reference simulator: mechanics only; knows no standard, no file format, no report."""

from pantocheck.model.catenary import (
    Catenary,
    Clamp,
    Dropper,
    Kind,
    MessengerSupport,
    ModalBand,
    Rayleigh,
    SteadyArm,
    TensionChange,
    Wire,
)
from pantocheck.model.discretised_line import DiscretisedLine, discretise, never_slack
from pantocheck.model.dynamics.simulation import History, Passage, simulate_passage
from pantocheck.model.pantograph import Pantograph, chain

__all__ = [
    "Catenary",
    "Clamp",
    "DiscretisedLine",
    "Dropper",
    "History",
    "Kind",
    "MessengerSupport",
    "ModalBand",
    "Pantograph",
    "Passage",
    "Rayleigh",
    "SteadyArm",
    "TensionChange",
    "Wire",
    "chain",
    "discretise",
    "never_slack",
    "simulate_passage",
]
