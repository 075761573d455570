"""Messages of a program: what is refused, with the key or the beginning of the line."""

import json
import math
from collections.abc import Callable
from typing import Any

import pytest

from pantocheck.conformance.runs.protocol_messages import (
    AnswerRefused,
    DeliveredAnswer,
    ErroredAnswer,
    SkippedAnswer,
    Started,
    encode_message,
    parse_message,
)

DIGEST = "0f" * 32
FILES = {"sidecar": {"file": "a.toml", "sha256": DIGEST}, "table": {"file": "a.csv", "sha256": DIGEST}}


def encode(**message: Any) -> bytes:
    return json.dumps(message).encode()


@pytest.mark.parametrize(
    ("message", "kind"),
    [
        ({"message": "started", "protocol": "pantocheck.command/1", "name": "p", "version": ""}, Started),
        ({"message": "delivered", "id": 3, "record": FILES, "notes": ["a"]}, DeliveredAnswer),
        ({"message": "delivered", "id": 3, "static": {"presag_mm": [1.0], "wave_speed_m_s": 1}}, DeliveredAnswer),
        ({"message": "skipped", "id": 3, "reason": "x" * 2000}, SkippedAnswer),
        ({"message": "errored", "id": 3, "reason": "x"}, ErroredAnswer),
    ],
)
def test_answer_is_parsed_by_its_kind(message: dict[str, Any], kind: type) -> None:
    assert isinstance(parse_message(encode(**message)), kind)


def test_answer_has_defaults_and_a_message_is_one_line_of_finite_numbers() -> None:
    answer = parse_message(encode(message="delivered", id=1))
    assert (answer.record, answer.static, answer.notes) == (None, {}, ())
    assert json.loads(encode_message("run", id=1, folder="a\nb")) == {"message": "run", "id": 1, "folder": "a\nb"}
    assert b"\n" not in encode_message("run", folder="a\nb")
    with pytest.raises(ValueError, match="not JSON compliant"):
        encode_message("run", time_limit_s=math.inf)


@pytest.mark.parametrize(
    ("message", "place"),
    [
        ({"message": "finished", "id": 3}, "message of pantocheck.command: Input tag 'finished'"),
        ({"id": 3}, "Unable to extract tag"),
        ({"message": "skipped", "id": 3, "reason": ""}, ": skipped.reason: "),
        ({"message": "skipped", "id": 3, "reason": "x" * 2001}, ": skipped.reason: "),
        ({"message": "skipped", "id": "3", "reason": "x"}, ": skipped.id: "),
        ({"message": "errored", "id": 3, "reason": "x", "more": 1}, ": errored.more: "),
        ({"message": "delivered", "id": 3, "record": {"sidecar": FILES["sidecar"]}}, ": delivered.record.table: "),
        ({"message": "delivered", "id": 3, "notes": ["a", ""]}, ": delivered.notes.1: "),
    ],
)
def test_wrong_answer_is_refused_with_its_key(message: dict[str, Any], place: str) -> None:
    with pytest.raises(AnswerRefused) as caught:
        parse_message(encode(**message))
    assert place in str(caught.value)


def test_sizes_of_an_answer_have_bounds() -> None:
    """A size at its bound is accepted, one more is refused."""

    def start(**keys: Any) -> bytes:
        return encode(**{"message": "started", "protocol": "p", "name": "p", "version": ""} | keys)

    def deliver(**keys: Any) -> bytes:
        return encode(message="delivered", id=1, **keys)

    sizes: list[tuple[int, Callable[[int], bytes]]] = [
        (100, lambda size: start(protocol="x" * size)),
        (200, lambda size: start(name="x" * size)),
        (200, lambda size: start(version="x" * size)),
        (500, lambda size: deliver(record=FILES | {"table": {"file": "x" * size, "sha256": DIGEST}})),
        (100, lambda size: deliver(static={f"key_{k}": 1.0 for k in range(size)})),
        (1000, lambda size: deliver(static={"key": [1.0] * size})),
        (20, lambda size: deliver(notes=["x"] * size)),
        (2000, lambda size: deliver(notes=["x" * size])),
    ]
    for largest, message in sizes:
        parse_message(message(largest))
        with pytest.raises(AnswerRefused):
            parse_message(message(largest + 1))
    for empty in (start(name=""), deliver(record=FILES | {"table": {"file": "", "sha256": DIGEST}})):
        with pytest.raises(AnswerRefused):
            parse_message(empty)


@pytest.mark.parametrize("line", [b"[" * 100_000, b"\xff" * 10, b"9" * 5000, b""])
def test_line_that_is_no_json_is_refused(line: bytes) -> None:
    with pytest.raises(AnswerRefused, match="not JSON"):
        parse_message(line)


@pytest.mark.parametrize(("length", "shown"), [(79, 79), (80, 80), (81, 80), (500, 80)])
def test_first_eighty_bytes_of_a_line_are_shown(length: int, shown: int) -> None:
    with pytest.raises(AnswerRefused) as caught:
        parse_message(b"x" * length)
    assert f"'{'x' * shown}'" in str(caught.value)
