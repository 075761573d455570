"""The messages: what is sent, what may come back, and the JSON Schema of both."""

import json
from typing import Annotated, Any, Final, Literal

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema

from pantocheck.conformance.cases.case_file import Discretisation, Filter
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import ChainTable, ContactTable, MatricesTable, ModesTable
from pantocheck.conformance.input_files.sourced_table import PROVENANCE, InputTable

PROTOCOL: Final = "pantocheck.command/1"

Text = Annotated[str, Field(min_length=1, max_length=2000)]


class AnswerRefused(ValueError):
    """A program answered with something that is no message: whatever it meant must not become a number."""


class Start(InputTable):
    """The first message."""

    message: Literal["start"] = "start"
    protocol: Annotated[Literal["pantocheck.command/1"], Field(description="version of the protocol")] = PROTOCOL
    suite_version: Annotated[str, Field(description="version of Pantocheck")]


class GivenPantograph(InputTable):
    """One pantograph of a run, in running order; one of chain, matrices and modes says what it is."""

    chain: ChainTable | None
    matrices: MatricesTable | None
    modes: ModesTable | None
    contact: ContactTable
    uplift_force_N: Annotated[float | None, Field(description="constant uplift force, or where tuning starts [N]")]
    target_mean_force_N: Annotated[
        float | None,
        Field(description="mean contact force over the evaluated stretch to tune the uplift force to [N]; null: none"),
    ]
    start_m: Annotated[float, Field(description="where it is at the beginning of the run [m]")]
    end_m: Annotated[float, Field(description="where it is at the end of the run [m]")]


class GivenCase(InputTable):
    """A case without its limits: all of its numbers, defaults filled in."""

    id: Annotated[str, Field(description="to be named in the sidecar of the record")]
    title: str
    speed_km_h: Annotated[float | None, Field(description="speed of the train; null: a check of the line at rest")]
    evaluated_m: Annotated[tuple[float, float], Field(description="start and end of the evaluated stretch [m]")]
    filter: Annotated[Filter, Field(description="filter of the graded force; best deliver the force unfiltered")]
    discretisation: Annotated[Discretisation, Field(description="that of the reference simulator, as a hint")]
    line: LineFile
    pantographs: tuple[GivenPantograph, ...]


class RunRequest(InputTable):
    """A case to run."""

    message: Literal["run"] = "run"
    id: Annotated[int, Field(ge=1, description="to be repeated in the answer")]
    folder: Annotated[str, Field(description="where record files go: the working folder of the program")]
    time_limit_s: Annotated[float, Field(gt=0, description="time until the answer is due [s]")]
    case: GivenCase


class Stop(InputTable):
    """The last message: the program ends."""

    message: Literal["stop"] = "stop"


class Started(InputTable):
    """Answer to `start`."""

    message: Literal["started"]
    protocol: Annotated[
        str, Field(max_length=100, description='version that the program speaks: "pantocheck.command/1"')
    ]
    name: Annotated[str, Field(min_length=1, max_length=200, description="of the simulator, as printed in reports")]
    version: Annotated[str, Field(max_length=200, description="of the simulator")]


class File(InputTable):
    """A file that was written."""

    file: Annotated[str, Field(min_length=1, max_length=500, description="its name, relative to the run's folder")]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="digest of its content")]


class RecordFiles(InputTable):
    """A record: its table of samples and the sidecar; see `pantocheck schema record`."""

    sidecar: File
    table: File


class DeliveredAnswer(InputTable):
    """Answer to `run`: it was done."""

    message: Literal["delivered"]
    id: int
    record: Annotated[RecordFiles | None, Field(description="null for a check of the line at rest")] = None
    static: Annotated[
        dict[str, float | Annotated[tuple[float, ...], Field(strict=False, max_length=1000)]],
        Field(
            default_factory=dict,
            max_length=100,
            description="quantities of the line at rest, by name; a list has one value per dropper",
        ),
    ]
    notes: Annotated[
        tuple[Text, ...], Field(strict=False, max_length=20, description="for the reader of a report")
    ] = ()


class SkippedAnswer(InputTable):
    """Answer to `run`: the system does not do such cases."""

    message: Literal["skipped"]
    id: int
    reason: Text


class ErroredAnswer(InputTable):
    """Answer to `run`: it was tried and went wrong."""

    message: Literal["errored"]
    id: int
    reason: Text


Answer = Started | DeliveredAnswer | SkippedAnswer | ErroredAnswer

_ANSWER: TypeAdapter[Answer] = TypeAdapter(Annotated[Answer, Field(discriminator="message")])
_REQUEST: TypeAdapter[Start | RunRequest | Stop] = TypeAdapter(
    Annotated[Start | RunRequest | Stop, Field(discriminator="message")]
)


def encode_message(message: str, **content: object) -> bytes:
    """A message to a program, on one line."""
    return json.dumps({"message": message, **content}, allow_nan=False).encode()


def parse_message(line: bytes) -> Answer:
    """A line of a program as a message.

    Raises
    ------
    AnswerRefused
        It is not one.
    """
    try:
        return _ANSWER.validate_python(json.loads(line))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise AnswerRefused(
            f"its answer is no message of {PROTOCOL}: {key + ': ' if key else ''}{first['msg']}"
        ) from None
    except (ValueError, RecursionError):  # not UTF-8, not JSON, or nested too deep
        shown = line[:80].decode("utf-8", "replace").strip()
        raise AnswerRefused(f"its answer is not JSON: {shown!r} (a log belongs on standard error)") from None


def request_schema(generator: type[GenerateJsonSchema]) -> dict[str, Any]:
    """JSON Schema of the messages to a program; the tables of a case have no provenance."""
    schema = _REQUEST.json_schema(schema_generator=generator)
    for table in schema["$defs"].values():
        table["properties"] = {key: value for key, value in table["properties"].items() if key not in PROVENANCE}
        table["required"] = [key for key in table.get("required", []) if key not in PROVENANCE]
    return schema


def answer_schema(generator: type[GenerateJsonSchema]) -> dict[str, Any]:
    """JSON Schema of the messages of a program."""
    return _ANSWER.json_schema(schema_generator=generator)
