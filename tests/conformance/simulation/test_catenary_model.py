"""Catenary of a case: weight of the droppers."""

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.simulation.catenary_model import COARSE, build_catenary
from pantocheck.model import discretise


def test_dropper_masses_belong_to_the_lengths_of_the_loaded_line() -> None:
    """A dropper of 0.117 kg/m has the mass of its length on the line that carries this mass.

    The lengths of the line with droppers without mass are 4 mm wrong. Those of the masses are accurate to 0.1 mm.
    """
    line = select_cases(["en50318-2018/ac-simple/static"])[0].line
    line = line.model_copy(update={"geometry": line.geometry.shorten(3)})
    catenary = build_catenary(line)
    lengths = discretise(catenary, COARSE).state.dropper_length
    errors = [abs(d.mass / 0.117 - length) for d, length in zip(catenary.droppers, lengths, strict=True)]
    assert max(errors) < 1e-4
