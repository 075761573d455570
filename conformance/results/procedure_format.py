"""EN 50318 procedure in results.json: the steps of a dossier, their verdicts and the data of their figures."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.results.comparison_format import ResponseComparison, StaticComparison
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.results_part import FiniteNumber, ResultsPart

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
    required: Annotated[bool, Field(description="whether the step decides the verdict; if not, it is for information")]
    state: Annotated[StepState, Field(description="error: its data could not be used")]
    verdict: Annotated[Verdict, Field(description="skip if the step was not done")] = "skip"
    unverified: Annotated[
        str | None, Field(description="reason why a pass counts as unverified; null: nothing is unverified")
    ] = None
    reason: Annotated[str | None, Field(description="reason why the step was not done, or remark on its verdict")] = (
        None
    )
    closest: Annotated[str | None, Field(description="criterion with the smallest margin; null: none counts")] = None
    margin: FiniteNumber | None = None
    uncertainty: Annotated[
        FiniteNumber | None,
        Field(description="half-width of the 95 % interval of its value and of its limit, on the scale of the margin"),
    ] = None
    cases: Annotated[list[str], Field(description="ids of the cases and pairs of this step")] = []
    criteria: Annotated[list[Criterion], Field(description="criteria that belong to no case")] = []
    notes: list[str] = []


class DeclaredParameter(ResultsPart):
    """Simulation parameter that the dossier declares, beside that of the runs."""

    name: str
    declared: str
    runs: Annotated[str, Field(description="range of the values that the runs state")]
    confirmed: Annotated[bool, Field(description="whether every run states a value that can be compared")]


class Evidence(ResultsPart):
    """Case or pair of runs, with the conditions that it verifies if it passed."""

    id: str
    passed: Annotated[bool, Field(description="pass, or an accepted unverified record")] = False
    line: Annotated[str, Field(description="name of the line in the dossier, or its title")]
    pantographs: Annotated[list[str], Field(description="names in the dossier, or titles, in running order")]
    speed_km_h: FiniteNumber
    spacing_m: list[FiniteNumber]
    inputs: Annotated[dict[str, FiniteNumber], Field(description="inputs whose change is claimed, by key")] = {}


class ValidityClaim(ResultsPart):
    """Claim on the range of validity, and the range of the evidence that passed."""

    kind: ClaimKind
    name: Annotated[str, Field(description="name of the line, pantograph or input; empty for speed and spacing")]
    unit: str
    claimed: Annotated[tuple[FiniteNumber, FiniteNumber] | None, Field(description="range; null: a line or pantograph")]
    verified: Annotated[
        tuple[FiniteNumber, FiniteNumber] | None, Field(description="range of the passed evidence; null: none")
    ] = None
    evidence: Annotated[
        list[str], Field(description="ids of the cases and pairs that passed under these conditions")
    ] = []
    verdict: Annotated[
        Verdict, Field(description="pass: inside the verified range, and every step before passes; skip: not verified")
    ] = "skip"
    reason: str | None = None


class JoinedQuantity(ResultsPart):
    """Differences of one quantity, simulated minus measured, joined over all compared pairs."""

    quantity: str
    pantograph: Annotated[int, Field(description="number of the pantograph, 0: the line")]
    runs: Annotated[int, Field(description="number of pairs with this quantity")]
    mean_difference: FiniteNumber
    uncertainty: Annotated[
        FiniteNumber | None,
        Field(description="half-width of the 95 % interval of the mean, from those of the runs; null: not known"),
    ]
    spread: Annotated[FiniteNumber | None, Field(description="standard deviation of the differences; null: one pair")]
    largest_difference: FiniteNumber
    largest_in: Annotated[str, Field(description="id of the pair with the largest difference")]


class Procedure(ResultsPart):
    """Procedure of EN 50318 for one dossier."""

    title: str
    digest: Annotated[str, Field(description="SHA-256 of the dossier and of the content of all files that it names")]
    note: str | None = None
    steps: Annotated[list[ProcedureStep], Field(description="every step, in the order of the procedure")]
    responses: Annotated[
        list[ResponseComparison], Field(description="frequency responses of the pantographs, measured and computed")
    ] = []
    statics: Annotated[
        list[StaticComparison], Field(description="values of the lines at rest, measured and computed")
    ] = []
    parameters: list[DeclaredParameter] = []
    joined: Annotated[list[JoinedQuantity], Field(description="line tests joined over the pairs")] = []
    evidence: list[Evidence] = []
    claims: list[ValidityClaim] = []
