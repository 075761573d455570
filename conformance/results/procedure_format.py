"""EN 50318 procedure in results.json: the steps of a dossier, their verdicts and the data of their figures."""

from typing import Literal, get_args

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.comparison_format import ResponseComparison, StaticComparison

StepName = Literal[
    "pantograph_model", "static_check", "simulation_parameters", "reference_models", "line_test", "limits_of_validity"
]
"""Step of the EN 50318 procedure, as a dossier states it."""

STEP_NAMES: tuple[StepName, ...] = get_args(StepName)
"""Steps in the order of the procedure."""

StepState = Literal["done", "not done", "error"]

ClaimKind = Literal["line", "pantograph", "speed", "spacing", "change"]
"""Subject of a claim on the range of validity."""


class ProcedureStep(ResultsPart):
    """Step of the procedure. A step is as good as its worst criterion, case and claim that counts.

    `margin` and `uncertainty` are those of the criterion with the smallest margin, which `closest` names.
    """

    step: StepName
    required: bool
    """Whether the step decides the verdict; if not, it is for information."""
    state: StepState
    """error: its data could not be used."""
    verdict: Verdict = "skip"
    """Skip if the step was not done."""
    unconfirmed: str | None = None
    """Reason why a pass counts as unconfirmed; null: nothing is unconfirmed."""
    reason: str | None = None
    """Reason why the step was not done, or remark on its verdict."""
    closest: str | None = None
    """Criterion with the smallest margin; null: none counts."""
    margin: FiniteNumber | None = None
    uncertainty: FiniteNumber | None = None
    """Half-width of the 95 % interval of its value and of its limit, on the scale of the margin."""
    cases: list[str] = []
    """Ids of the cases and pairs of this step."""
    criteria: list[Criterion] = []
    """Criteria that belong to no case."""
    notes: list[str] = []


class DeclaredParameter(ResultsPart):
    """Simulation parameter that the dossier declares, beside that of the runs."""

    name: str
    declared: str
    runs: str
    """Range of the values that the runs state."""
    confirmed: bool
    """Whether every run states a value that can be compared."""


class Evidence(ResultsPart):
    """Case or pair of runs, with the conditions that it verifies if it passed."""

    id: str
    passed: bool = False
    """Pass, or an accepted unconfirmed record."""
    line: str
    """Name of the line in the dossier, or its title."""
    pantographs: list[str]
    """Names in the dossier, or titles, in running order."""
    speed_km_h: FiniteNumber
    spacing_m: list[FiniteNumber]
    inputs: dict[str, FiniteNumber] = {}
    """Inputs whose change is claimed, by key."""


class ValidityClaim(ResultsPart):
    """Claim on the range of validity, and the range of the evidence that passed."""

    kind: ClaimKind
    name: str
    """Name of the line, pantograph or input; empty for speed and spacing."""
    unit: str
    claimed: tuple[FiniteNumber, FiniteNumber] | None
    """Range; null: a line or pantograph."""
    verified: tuple[FiniteNumber, FiniteNumber] | None = None
    """Range of the passed evidence; null: none."""
    evidence: list[str] = []
    """Ids of the cases and pairs that passed under these conditions."""
    verdict: Verdict = "skip"
    """pass: inside the verified range, and every step before passes; skip: not verified."""
    reason: str | None = None


class JoinedQuantity(ResultsPart):
    """Differences of one quantity, simulated minus measured, joined over all compared pairs."""

    quantity: str
    pantograph: int
    """Number of the pantograph, 0: the line."""
    runs: int
    """Number of pairs with this quantity."""
    mean_difference: FiniteNumber
    uncertainty: FiniteNumber | None
    """Half-width of the 95 % interval of the mean, from those of the runs; null: not known."""
    spread: FiniteNumber | None
    """Standard deviation of the differences; null: one pair."""
    largest_difference: FiniteNumber
    largest_in: str
    """Id of the pair with the largest difference."""


class Procedure(ResultsPart):
    """Procedure of EN 50318 for one dossier."""

    title: str
    digest: str
    """SHA-256 of the dossier and of the content of all files that it names."""
    note: str | None = None
    steps: list[ProcedureStep]
    """Every step, in the order of the procedure."""
    responses: list[ResponseComparison] = []
    """Frequency responses of the pantographs, measured and computed."""
    statics: list[StaticComparison] = []
    """Values of the lines at rest, measured and computed."""
    parameters: list[DeclaredParameter] = []
    joined: list[JoinedQuantity] = []
    """Line tests joined over the pairs."""
    evidence: list[Evidence] = []
    claims: list[ValidityClaim] = []
