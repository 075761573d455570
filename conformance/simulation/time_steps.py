"""Compiled simulations of the model. They need the extra `simulator`; the first simulation loads them."""

from collections.abc import Callable

from pantocheck.conformance.input_files.extras import refuse_missing_package
from pantocheck.model.catenary import Catenary
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.drop_values import FreeDecay, MassDropSetup
from pantocheck.model.dynamics.passage import History, Passage


def integrate_passage(
    line: DiscretisedLine, passage: Passage, progress: Callable[[float], None] | None = None
) -> History:
    """Simulate a passage; parameters and errors as in `model.simulate_passage`.

    Raises:
        InputError: The extra `simulator` is not installed.
    """
    with refuse_missing_package("the simulation of a passage"):
        from pantocheck.model.dynamics.simulation import simulate_passage
    return simulate_passage(line, passage, progress)


def integrate_mass_drop(
    catenary: Catenary, element_length: float, test: MassDropSetup, progress: Callable[[float], None] | None = None
) -> FreeDecay:
    """Simulate a mass drop; parameters and errors as in `model.dynamics.mass_drop.simulate_mass_drop`.

    Raises:
        InputError: The extra `simulator` is not installed.
    """
    with refuse_missing_package("the simulation of a mass drop"):
        from pantocheck.model.dynamics.mass_drop import simulate_mass_drop
    return simulate_mass_drop(catenary, element_length, test, progress)
