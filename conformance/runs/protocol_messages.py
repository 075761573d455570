"""Messages to and from a program, and their JSON Schemas."""

import json
from typing import Annotated, Any, Final, Literal

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema

from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.core.sourced_table import PROVENANCE, InputTable, is_absent
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.force_law import PointOfForce
from pantocheck.conformance.pantograph.head_tables import HeadTable
from pantocheck.conformance.pantograph.pantograph_file import ChainTable, ContactTable, MatricesTable, ModesTable
from pantocheck.conformance.pantograph.transfer_function import TransferFunctionTable
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.runs.derived_values import Derived

PROTOCOL: Final = "pantocheck.command/1"
"""Version of the protocol."""

Text = Annotated[str, Field(min_length=1, max_length=2000)]


class AnswerRefused(ValueError):
    """An answer of a program is not a valid message, so it must not be graded."""


class Start(InputTable):
    """First message to a program."""

    message: Literal["start"] = "start"
    protocol: Literal["pantocheck.command/1"] = PROTOCOL
    """Version of the protocol."""
    suite_version: str
    """Version of Pantocheck."""


class RequestedAppliedForces(InputTable):
    """Applied forces from the force law of a pantograph at the speed of the case; their sum is the uplift force."""

    static_force_N: float
    """Static force, at uplift_force_on of the model [N]."""
    aerodynamic_force_N: float
    """Mean aerodynamic force [N]."""
    aerodynamic_force_on: PointOfForce


class RequestedPantograph(InputTable):
    """Pantograph of a run, in running order. One of chain, matrices, modes and transfer function describes it."""

    chain: ChainTable | None
    matrices: MatricesTable | None
    modes: ModesTable | None
    transfer_function: Annotated[TransferFunctionTable | None, Field(exclude_if=is_absent)] = None
    contact: ContactTable
    head: Annotated[HeadTable | None, Field(exclude_if=is_absent)] = None
    """Structure of the head; default: one rigid strip."""
    uplift_force_N: float | None
    """Constant uplift force, or start value of the tuning [N]."""
    target_mean_force_N: float | None
    """Mean contact force over the analysis section for the tuning [N]; null: no tuning."""
    applied_forces: Annotated[RequestedAppliedForces | None, Field(exclude_if=is_absent)] = None
    """Parts of the uplift force with different points of application; default: one point."""
    start_m: float
    """Position at the start of the run [m]."""
    end_m: float
    """Position at the end of the run [m]."""


class RequestedCase(InputTable):
    """Case without limits: all numbers, defaults included."""

    id: str
    """Id of the case, to be repeated in the sidecar of the record."""
    case_digest: str
    """Digest of the inputs of the case, to be repeated in the sidecar of the record."""
    title: str
    features: Annotated[tuple[str, ...], Field(strict=False)]
    """Features that the case uses, in alphabetic order."""
    speed_km_h: float | None
    """Speed of the train; null: check of the line at rest."""
    evaluated_m: tuple[float, float]
    """Start and end of the analysis section [m]."""
    filter: Filter
    """Filter of the graded force; deliver the force unfiltered if possible."""
    discretisation: Discretisation
    """Discretisation of the reference simulator, for information."""
    line: LineFile
    pantographs: tuple[RequestedPantograph, ...]
    derived: Derived
    """Values that follow from the inputs by the conventions of the suite."""


class RunRequest(InputTable):
    """Request to run a case."""

    message: Literal["run"] = "run"
    id: Annotated[int, Field(ge=1)]
    """Number of the run, to be repeated in the answer."""
    folder: str
    """Folder for record files: the working folder of the program."""
    time_limit_s: Annotated[float, Field(gt=0)]
    """Time limit of the answer [s]."""
    case: RequestedCase


class Stop(InputTable):
    """Last message: the program ends."""

    message: Literal["stop"] = "stop"


class Started(InputTable):
    """Answer to `start`."""

    message: Literal["started"]
    protocol: Annotated[str, Field(max_length=100)]
    """Version of the protocol of the program: "pantocheck.command/1"."""
    name: Annotated[str, Field(min_length=1, max_length=200)]
    """Name of the simulator in reports."""
    version: Annotated[str, Field(max_length=200)]
    """Version of the simulator."""
    features: Annotated[
        tuple[Annotated[str, Field(max_length=100)], ...] | None, Field(strict=False, max_length=1000)
    ] = None
    """Features that the program simulates; a case that uses another one is skipped, and without this list every
    case.
    """


class File(InputTable):
    """Delivered file."""

    file: Annotated[str, Field(min_length=1, max_length=500)]
    """Path of the file, relative to the folder of the run."""
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """Digest of the content."""


class RecordFiles(InputTable):
    """Record: table of samples and sidecar, see `pantocheck schema record`."""

    sidecar: File
    table: File
    shapes: File | None = None
    """Shapes of the wires, which the sidecar names; null: none."""


class DeliveredAnswer(InputTable):
    """Answer to `run`: results."""

    message: Literal["delivered"]
    id: int
    record: RecordFiles | None = None
    """Files of the record; null for a check of the line at rest."""
    static: Annotated[
        dict[str, float | Annotated[tuple[float, ...], Field(strict=False, max_length=1000)]],
        Field(default_factory=dict, max_length=100),
    ]
    """Quantities of the line at rest, by name; lists have a value per dropper."""
    notes: Annotated[tuple[Text, ...], Field(strict=False, max_length=20)] = ()
    """Notes for the reader of the report."""


class SkippedAnswer(InputTable):
    """Answer to `run`: the system does not support the case."""

    message: Literal["skipped"]
    id: int
    reason: Text


class ErroredAnswer(InputTable):
    """Answer to `run`: the simulation failed."""

    message: Literal["errored"]
    id: int
    reason: Text


Answer = Started | DeliveredAnswer | SkippedAnswer | ErroredAnswer

_ANSWER: TypeAdapter[Answer] = TypeAdapter(Annotated[Answer, Field(discriminator="message")])
_REQUEST: TypeAdapter[Start | RunRequest | Stop] = TypeAdapter(
    Annotated[Start | RunRequest | Stop, Field(discriminator="message")]
)


def encode_message(message: str, **content: object) -> bytes:
    """Encode a message to a program on one line."""
    return json.dumps({"message": message, **content}, allow_nan=False).encode()


def parse_message(line: bytes) -> Answer:
    """Parse a line of a program as a message.

    Raises:
        AnswerRefused: The line is not a valid message.
    """
    try:
        return _ANSWER.validate_python(json.loads(line))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise AnswerRefused(
            f"its answer is not a valid message of pantocheck.command: {key + ': ' if key else ''}{first['msg']}"
        ) from None
    except (ValueError, RecursionError):  # Not UTF-8, not JSON, or nested too deeply.
        shown = line[:80].decode("utf-8", "replace").strip()
        raise AnswerRefused(f"its answer is not JSON: {shown!r} (write a log to the standard error)") from None


def request_schema(generator: type[GenerateJsonSchema]) -> dict[str, Any]:
    """JSON Schema of the messages to a program; its tables have no provenance."""
    schema = _REQUEST.json_schema(schema_generator=generator)
    for table in schema["$defs"].values():
        table["properties"] = {key: value for key, value in table["properties"].items() if key not in PROVENANCE}
        table["required"] = [key for key in table.get("required", []) if key not in PROVENANCE]
    return schema


def answer_schema(generator: type[GenerateJsonSchema]) -> dict[str, Any]:
    """JSON Schema of the answers of a program."""
    return _ANSWER.json_schema(schema_generator=generator)
