"""The reference simulator: mechanics only; knows no standard, no file format, no report."""

from pantocheck.model.catenary import (
    Catenary,
    Clamp,
    Dropper,
    Kind,
    MessengerSupport,
    Rayleigh,
    SteadyArm,
    TensionChange,
    Wire,
)
from pantocheck.model.line import Discretised, discretise, never_slack
from pantocheck.model.pantograph import Pantograph, chain
from pantocheck.model.simulation import History, Passage, run

__all__ = [
    "Catenary",
    "Clamp",
    "Discretised",
    "Dropper",
    "History",
    "Kind",
    "MessengerSupport",
    "Pantograph",
    "Passage",
    "Rayleigh",
    "SteadyArm",
    "TensionChange",
    "Wire",
    "chain",
    "discretise",
    "never_slack",
    "run",
]
