"""Schemes of pantographs that are chains."""

from typing import Any

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.pages.line_figure import DrawnChain, draw_chain, name_pantographs, scheme_figures
from pantocheck.conformance.results.results_format import CaseResult, InputGroup


def group(name: str, **values: Any) -> dict[str, Any]:
    return {"group": name, "trust": "secondary", "source": "a book", "values": values}


def chain_case(**changes: Any) -> CaseResult:
    """Case with a chain of two masses for each of two pantographs."""
    chain = {"masses_kg": [6.0, 5.5], "stiffness_N_m": [0.0, 7000.0], "damping_N_s_m": [60.0, 0.0]} | changes
    contact = {"stiffness_N_m": 50000.0}
    tables = {"chain": chain, "contact": contact}
    return case_with(*(group(f"pantograph {n}.{name}", **tables[name]) for n in (1, 2) for name in tables))


def case_with(*groups: dict[str, Any]) -> CaseResult:
    """Case with other inputs."""
    [case] = select_cases(["en50318-2002/250"])
    inputs = [InputGroup.model_validate(group) for group in groups]
    return build_ungraded(case, "skip", "not run").model_copy(update={"inputs": inputs})


def test_scheme_has_the_values_of_its_chain() -> None:
    [case] = select_cases(["en50318-2002/250"])
    content = build_ungraded(case, "skip", "not run")
    [figure] = scheme_figures(content, ())
    for text in ("frame 15 kg", "head 7.2 kg", "50 N/m", "4200 N/m", "90 N s/m", "10 N s/m", "50000 N/m"):
        assert f">{text}<" in figure.svg
    assert figure.caption == "Pantograph 1: masses, springs and dampers, from base to head."
    assert figure.alternative.endswith("frame 15 kg, head 7.2 kg.")
    [figure] = scheme_figures(chain_case(), ())
    assert figure.caption.startswith("Pantographs 1 and 2: ")
    assert scheme_figures(chain_case(), (chain_case(),)) == ()
    assert len(scheme_figures(chain_case(masses_kg=[6.0, 5.0]), (chain_case(),))) == 1
    assert ">0 N/m<" not in figure.svg
    assert ">0 N s/m<" not in figure.svg


def test_scheme_and_first_page_have_the_strips_and_the_law_of_the_contact() -> None:
    chain = group("pantograph 1.chain", masses_kg=[6.0, 5.5], stiffness_N_m=[0.0, 7000.0], damping_N_s_m=[60.0, 0.0])
    strips = {"strip.mass_kg": [3.0, 2.5], "strip.stiffness_N_m": [1e4, 9e3], "strip.damping_N_s_m": [20.0, 0.0]}
    case = case_with(chain, group("pantograph 1.head", **strips), group("pantograph 1.contact", law="constraint"))
    [figure] = scheme_figures(case, ())
    for text in ("3 kg", "2.5 kg", "10000 N/m", "9000 N/m", "20 N s/m"):
        assert figure.svg.count(f">{text}<") == 1, text
    assert figure.svg.count(">constraint<") == 2
    assert name_pantographs(case) == "1 × masses 6, 5.5 kg and strips 3, 2.5 kg"
    assert len(scheme_figures(case, (case_with(chain, group("pantograph 1.contact", law="constraint")),))) == 1


def test_uplift_force_acts_on_the_stated_mass() -> None:
    """The arrow stands at the height of the label, and moves with the mass: one level is 0.62 in, 44.64 points."""
    heights = []
    for lifted in (0, 1):
        chain = DrawnChain((6.0, 5.5), (100.0, 7000.0), (60.0, 0.0), ("frame", "head"), lifted, "50000 N/m")
        [text] = [text for text in draw_chain.__wrapped__(chain).axes[0].texts if text.text == "uplift force"]
        heights.append(72 * text.y)
    assert abs(heights[1] - heights[0] - 44.64) < 1e-3


def test_values_that_are_no_chain_give_no_scheme() -> None:
    """Long chains are stored as ranges; another program may write anything."""
    stored_range = {"count": 13, "lowest": 1.0, "highest": 2.0}
    for masses in (stored_range, [6.0], ["6", "5"], []):
        assert scheme_figures(chain_case(masses_kg=masses), ()) == ()
    assert scheme_figures(case_with(group("pantograph 1.chain")), ()) == ()
    values = {"masses_kg": 9.0, "stiffness_N_m": 50.0, "damping_N_s_m": 30.0}
    [figure] = scheme_figures(chain_case(**values), ())
    assert ">mass 1 9 kg<" in figure.svg
    named = scheme_figures(chain_case(names=["frame", "head"], uplift_force_on="head"), ())
    numbered = scheme_figures(chain_case(names=["frame", "head"], uplift_force_on=2.0), ())
    assert named[0].svg == numbered[0].svg
