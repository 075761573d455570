"""Self-test of the suite for the guide: verdict on every known fault."""

from pantocheck.conformance.app.self_test.bench import MutantResult, run_self_test
from pantocheck.conformance.app.self_test.numerical_faults import NumericalResult, run_numerical_faults
from pantocheck.conformance.cases.library import select_cases
from verification.guide.guide_format import DetectedFault, SelfTestSummary

RECORD_CASES = ("en50318-2002/250", "en50318-2002/300")
FAULT_CASES = (*RECORD_CASES, "en50318-2018/ac-simple/320-twin")
"""Cases of the faults of records, and of the numerical faults, as in `pantocheck system self-test`."""


def summarise_self_test() -> SelfTestSummary:
    """Run the self-test and summarise it."""
    self_test = run_self_test(select_cases(RECORD_CASES), _ignore)
    with_train = [case for case in select_cases(FAULT_CASES) if not case.is_static]
    return SelfTestSummary(
        reference={name: verdict for name, (verdict, _) in self_test.reference.items()},
        records=[describe_mutant(row) for row in (*self_test.severe, *self_test.mild)],
        numerical=[describe_fault(row) for row in run_numerical_faults(with_train, _ignore)],
    )


def _ignore(name: str) -> None:
    pass


def describe_mutant(result: MutantResult) -> DetectedFault:
    """Verdict on a fault of a record; a mild fault is detected if its verdict is not a pass."""
    expected = result.mutant.expected_check
    found = expected if expected is not None and result.detected else ", ".join(result.checks)
    return DetectedFault(
        name=result.mutant.name,
        case=result.case,
        verdict=result.verdict,
        detected_by=found,
        must_be_detected=expected is not None,
        detected=result.detected if expected is not None else result.verdict != "pass",
    )


def describe_fault(result: NumericalResult) -> DetectedFault:
    """Verdict of the verification on a numerical fault."""
    return DetectedFault(
        name=result.fault.name,
        case=result.case,
        verdict=result.verification,
        detected_by=", ".join(result.outside),
        must_be_detected=result.fault.must_be_detected,
        detected=result.verification == "fail",
    )
