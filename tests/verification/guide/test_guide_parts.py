"""Parts of the guide beside the closed forms: peers, self-test, computing times and limitations."""

from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from pantocheck.conformance.app.self_test.mutants import MILD, MUTANTS, MutantResult
from pantocheck.conformance.app.self_test.numerical_faults import FAULTS, NumericalResult
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from pantocheck.conformance.runs.command_system import build_case_message
from verification.formulations.difference_passage import difference_quantities
from verification.formulations.finite_differences import find_case, reference_quantities
from verification.formulations.point_convergence import extrapolate, shorten
from verification.guide import peers
from verification.guide.guide_building import list_effects
from verification.guide.guide_driver import LIMITATIONS_FILE, read_limitations
from verification.guide.guide_tasks import DURATIONS_S, list_tasks, list_timings
from verification.guide.library_values import describe_fault, describe_mutant, measure_passage, name_processor
from verification.guide.peers.peer_list import PEERS, Peer, evaluate_ishigami, run_peer
from verification.guide.peers.subspace_modes import KNOWN_MODES, build_known_drop
from verification.guide.topics.line_elements import CONTACTS, LINES, OTHERS, SPANS, UPLIFT_N

ROOT = Path(__file__).parents[3]


def test_peers_are_imported_when_they_are_compared_and_run_where_they_are_installed() -> None:
    def fail() -> list[object]:
        raise AssertionError("run without its package")

    result = run_peer(Peer("pantocheck-no-such-package", "title", "setting", fail))  # type: ignore[arg-type]
    assert (result.version, result.comparisons) == (None, [])
    for path in Path(peers.__file__).parent.glob("*.py"):
        if path.name != "exudyn_engine.py":
            lines = path.read_text("utf-8").splitlines()
            assert not [
                line for line in lines if line.startswith(("import skfem", "from skfem", "from SALib", "from pyoma2"))
            ]


@pytest.mark.parametrize(
    ("name", "module"), [("exudyn", "exudyn"), ("scikit-fem", "skfem"), ("pyOMA-2", "pyoma2"), ("SALib", "SALib")]
)
def test_peer_agrees_where_it_is_installed(name: str, module: str) -> None:
    pytest.importorskip(module, reason=f"{name} is optional: pip install 'pantocheck[peers]'")
    result = run_peer(PEERS[name])
    assert result.version is not None
    assert result.comparisons
    assert [(row.key, row.deviation) for row in result.comparisons if not row.agrees] == []


def test_known_modes_and_points_of_the_peers() -> None:
    """The suite alone, as in the comparison with pyOMA-2: within 1e-5 in frequency and 1e-3 in damping."""
    (found,) = identify_modes((build_known_drop(),))
    values = np.array([(mode.frequency_Hz, mode.damping_ratio) for mode in found.modes])
    np.testing.assert_allclose(values[:, 0], list(KNOWN_MODES), rtol=1e-5)
    np.testing.assert_allclose(values[:, 1], list(KNOWN_MODES.values()), rtol=1e-3)
    # sin x1 = 1, sin^2 x2 = 1, x3 = 2: 1 + 7 + 0.1 * 16.
    points = np.array([[np.pi / 2, np.pi / 2, 2.0], [0.0, 0.0, 3.0]])
    assert evaluate_ishigami(points) == pytest.approx([9.6, 0.0])


def _mutant_result(number: int, verdict: Verdict, detected: bool, optional: bool = False) -> MutantResult:
    mutant = (MILD if optional else MUTANTS)[number]
    return MutantResult(mutant, "case", verdict, "pass", (), ("content",), detected, "reason")


def test_fault_of_a_record_is_detected_by_the_expected_check_or_not_at_all() -> None:
    found, missed = describe_mutant(_mutant_result(0, "error", True)), describe_mutant(_mutant_result(0, "pass", False))
    assert (found.detected, found.must_be_detected, found.detected_by) == (True, True, MUTANTS[0].expected_check)
    assert (missed.detected, missed.detected_by) == (False, "content")
    mild = describe_mutant(_mutant_result(0, "pass", True, optional=True))
    assert (mild.detected, mild.must_be_detected) == (False, False)


@pytest.mark.parametrize(("verification", "detected"), [("fail", True), ("pass", False), ("info", False)])
def test_numerical_fault_is_detected_by_a_failed_verification(verification: Verdict, detected: bool) -> None:
    described = describe_fault(NumericalResult(FAULTS[0], "case", "pass", verification, ("std_force_N",)))
    assert (described.detected, described.must_be_detected, described.verdict) == (detected, True, verification)


def test_timing_states_the_ratio_to_the_simulated_time() -> None:
    """From 60 m to the end of the run at 250 km/h."""
    timing = measure_passage("en50318-2002/250")
    (case,) = select_cases(["en50318-2002/250"])
    assert timing.simulated_s == pytest.approx((case.end - case.start) / case.speed)
    assert timing.ratio == pytest.approx(timing.process_s / timing.simulated_s)
    assert timing.process_s > 0
    assert name_processor()


def test_limitations_have_one_home_to_which_the_documentation_leads() -> None:
    limitations = read_limitations()
    assert len(limitations) >= 5
    assert all(part.title and part.sentences for part in limitations)
    file = ROOT / "docs" / LIMITATIONS_FILE
    assert sum(len(part.sentences) for part in limitations) == file.read_text("utf-8").count("\n* ")
    for page in ("README.md", "docs/guide.md"):
        assert LIMITATIONS_FILE in (ROOT / page).read_text("utf-8")


def test_effects_of_the_exact_model_and_long_parts_exist() -> None:
    free, fixed = list_effects()
    assert (free.relative_pct["max_uplift_at_support_mm"], free.absolute["min_force_N"]) == (2.5, 4.6)
    assert (fixed.relative_pct["max_uplift_at_support_mm"], fixed.absolute["min_force_N"]) == (4.3, 1.4)
    # A duration of a part that is renamed would be lost.
    assert DURATIONS_S.keys() <= {task.name for task in (*list_tasks(), *list_timings())}


def test_every_element_of_a_line_and_every_contact_law_is_a_row() -> None:
    assert sorted([*LINES, *OTHERS]) == sorted(element.__name__ for element in ELEMENTS)
    laws = get_args(ContactTable.model_fields["law"].annotation)
    assert {"spring", *(contact.law for contact in CONTACTS.values())} == set(laws)


@pytest.mark.thorough
@pytest.mark.parametrize("change", ["masses", "springs"])
def test_row_of_an_element_finds_one_that_is_left_out(change: str) -> None:
    """Without its element the second formulation is beyond both tolerances; 0.5 m apart its points leave 0.7 %."""
    case, plain = (shorten(find_case(name), SPANS) for name in (LINES["Wires"] + f"+{change}", LINES["Wires"]))
    ours = reference_quantities(case, 0.5, 1e-3, (UPLIFT_N,))
    error = {
        name: abs(
            difference_quantities(build_case_message(other), 0.25, (UPLIFT_N,))[1, "rms_5_20_N"] / ours[1, "rms_5_20_N"]
            - 1
        )
        for name, other in (("with", case), ("without", plain))
    }
    assert error["with"] < 0.02
    assert error["without"] > 0.03


def test_limit_of_halved_steps_has_their_order() -> None:
    """1 + h and 1 + h^2 from steps of 1, 1/2 and 1/4; where a difference grows, the last value stays."""
    for order in (1, 2):
        assert extrapolate([1 + h**order for h in (1.0, 0.5, 0.25)]) == pytest.approx(1.0)
    assert extrapolate([1 + (-0.5) ** k for k in range(3)]) == pytest.approx(1.0)
    assert extrapolate([1.0, 1.1, 1.3]) == 1.3
