"""Numerical faults of a simulator, which the verification detects where the EN 50318 criteria let them pass."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import DiscretisedLine, discretise, make_droppers_bilateral
from pantocheck.model.discretisation.connectors import build_connectors
from pantocheck.model.discretisation.discretised_line import with_damping


# Lines with one numerical fault each.
def leave_out_residual_flexibility(line: DiscretisedLine) -> DiscretisedLine:
    """Leave out the residual flexibility at contacts, droppers, arms and clamps."""
    beams = line.beams._replace(flexibility=np.zeros_like(line.beams.flexibility))
    return replace(line, beams=beams, connectors=build_connectors(line.catenary, line.mesh, beams, line.state))


def scale_damping(line: DiscretisedLine, factor: float) -> DiscretisedLine:
    """Multiply every Rayleigh coefficient of a line by a factor."""
    scaled = {
        kind: replace(
            rayleigh,
            mass_coefficient=factor * rayleigh.mass_coefficient,
            stiffness_coefficient=factor * rayleigh.stiffness_coefficient,
        )
        for kind, rayleigh in line.catenary.damping.items()
    }
    return with_damping(line, scaled)


TRUST: Final = "secondary"


@dataclass(frozen=True)
class NumericalFault:
    """A fault of the equations or of their solution."""

    name: str
    """Short name."""
    element_m: float | None
    """Element length [m]; None: that of the case."""
    change: Callable[[DiscretisedLine], DiscretisedLine]
    """Change of the discretised line."""
    must_be_detected: bool
    """Whether the verification must fail on every case; otherwise the fault shows the limit of detection."""


@dataclass(frozen=True)
class NumericalResult:
    """Two verdicts on a numerical fault."""

    fault: NumericalFault
    case: str
    """Id of the case."""
    criteria: Verdict
    """Verdict by the EN 50318 criteria."""
    verification: Verdict
    """Verdict by verification."""
    outside: tuple[str, ...]
    """Verified quantities outside their limits."""

    @property
    def detected(self) -> bool:
        """Whether the verification detects the fault; true for a fault that may remain undetected."""
        return self.verification == "fail" or not self.fault.must_be_detected


def keep_line(line: DiscretisedLine) -> DiscretisedLine:
    """Leave the line as it is, for a fault elsewhere."""
    return line


FAULTS: tuple[NumericalFault, ...] = (
    NumericalFault("mesh of 2 m", 2.0, keep_line, must_be_detected=True),
    NumericalFault("mesh of 2 m, no residual flexibility", 2.0, leave_out_residual_flexibility, must_be_detected=True),
    NumericalFault("no slackening", None, make_droppers_bilateral, must_be_detected=True),
    NumericalFault("three times the damping", None, lambda line: scale_damping(line, 3.0), must_be_detected=True),
    NumericalFault("no damping", None, lambda line: scale_damping(line, 0.0), must_be_detected=True),
    NumericalFault("no residual flexibility", None, leave_out_residual_flexibility, must_be_detected=False),
    NumericalFault("half the damping", None, lambda line: scale_damping(line, 0.5), must_be_detected=False),
    NumericalFault("twice the damping", None, lambda line: scale_damping(line, 2.0), must_be_detected=False),
)
"""Numerical faults, the severe ones first."""


def run_numerical_faults(cases: Sequence[Case], progress: Callable[[str], None]) -> tuple[NumericalResult, ...]:
    """Run the faults on cases that have converged values; `progress` receives the name of each fault first."""
    results = []
    for fault in FAULTS:
        progress(fault.name)
        results += [_run_fault(fault, case) for case in cases if find_converged(case.id) is not None]
    return tuple(results)


def _run_fault(fault: NumericalFault, case: Case) -> NumericalResult:
    mesh = case.file.discretisation
    element = fault.element_m or mesh.element_m
    line = fault.change(discretise(build_catenary(case.line), element))
    passage = run_passage(case, line, mesh.model_copy(update={"element_m": element}))
    result = grade_case(case, Delivered(passage.record), TRUST)
    verification = result.verification
    failed = [] if verification is None else [row for row in verification.criteria if row.verdict == "fail"]
    return NumericalResult(
        fault=fault,
        case=case.id,
        criteria=result.criteria_verdict or result.verdict,
        verification="info" if verification is None else verification.verdict,
        outside=tuple(dict.fromkeys(row.quantity for row in failed)),
    )
