"""Program as a system under test: messages, deliveries and failures."""

import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from numpy.testing import assert_allclose

from helpers.listed_spans import list_spans
from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.execution.plan import read_plan
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.program import split_arguments
from pantocheck.conformance.runs.protocol_messages import (
    AnswerRefused,
    DeliveredAnswer,
    ErroredAnswer,
    SkippedAnswer,
    Started,
    encode_message,
    parse_message,
)
from pantocheck.conformance.runs.system import Delivered, Errored, Skipped, System
from pantocheck.conformance.runs.system_choice import choose_system

Start = Callable[..., System]
"""Function that starts the program with a fault."""
# Program with one fault, which its first argument names.
PROGRAM = """
import hashlib, json, os, shutil, subprocess, sys, time
how, records, log = sys.argv[1:4]
FEATURES = ["bending_stiffness", "chain", "droppers", "listed_spans", "presag", "rayleigh_damping", "steady_arms"]
if how == "no features":
    FEATURES = None
def say(**message):
    sys.stdout.write(json.dumps(message) + "\\n")
    sys.stdout.flush()
def digest(name):
    return {"file": name, "sha256": hashlib.sha256(open(name, "rb").read()).hexdigest()}
def hang():
    time.sleep(1000)
for line in sys.stdin:
    message = json.loads(line)
    with open(log, "a") as file:
        file.write(line)
    if message["message"] == "stop":
        if how == "deaf":
            hang()
        break
    if message["message"] == "start":
        if how == "slow start":
            hang()
        if how == "old":
            say(message="started", protocol="pantocheck.command/0", name="p", version="1")
            continue
        say(message="started", protocol="pantocheck.command/1", name="p", version="1", features=FEATURES)
        continue
    case, number = message["case"]["id"], message["id"]
    if how == "crash" and case.endswith("250"):
        sys.exit("line 3\\nno licence left")
    if how == "abort":
        os.abort()
    if how == "hang":
        hang()
    if how == "child":
        subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"], start_new_session=True)
        subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"])
        hang()
    if how == "daemon":
        subprocess.Popen(
            [sys.executable, "-S", "-c", "import os, time; os.fork() and os._exit(0); time.sleep(1001)"],
            start_new_session=True, env={}, stdin=-3, stdout=-3, stderr=-3,
        ).wait()
    if how == "hang with daemon":
        subprocess.Popen([sys.executable, "-S", "-c", "import time; time.sleep(1001)"], start_new_session=True, env={})
        hang()
    if how == "garbage":
        print("Reading licence ...", flush=True)
    if how == "partial":
        sys.stdout.write('{"message": "deliv')
        sys.exit()
    if how == "long line":
        sys.stdout.write("x" * 2000000)
    if how == "flood":
        while True:
            print('{"message": "started", "protocol": "x", "name": "x", "version": ""}')
    if how == "binary":
        os.write(1, bytes(range(128, 256)) + b"\\n")
    if how == "nan":
        say(message="delivered", id=number, static={"wave_speed_m_s": float("nan")})
    if how == "skip":
        say(message="skipped", id=number, reason="no such line")
        continue
    if how == "error":
        say(message="errored", id=number, reason="diverged at 1.2 s")
        continue
    if how == "wrong id":
        number = 7
    if how == "closes":
        os.close(1)
        hang()
    for name in ("record.toml", "record.csv"):
        shutil.copy(os.path.join(records, name), name)
    if how == "outside":
        shutil.copy("record.toml", "../stray.toml")
        record = {"sidecar": dict(digest("record.toml"), file="../stray.toml"), "table": digest("record.csv")}
    elif how == "link":
        os.remove("record.csv")
        os.symlink(os.path.join(records, "record.csv"), "record.csv")
        record = {"sidecar": digest("record.toml"), "table": digest("record.csv")}
    else:
        record = {"sidecar": digest("record.toml"), "table": digest("record.csv")}
    if how == "absent":
        os.remove("record.csv")
    if how == "changed":
        with open("record.csv", "a") as file:
            file.write("\\n")
    if how == "other table":
        shutil.copy("record.csv", "b.csv")
        record["table"] = digest("b.csv")
    say(message="delivered", id=number, record=record, static={"wave_speed_m_s": 121.7}, notes=["as asked"])
    if how == "late exit":
        sys.exit(9)
    if how == "late crash":
        os.kill(os.getpid(), 11)
    if how == "late error":
        say(message="errored", id=number, reason="the licence ended")
"""


@pytest.fixture
def program(case_250: Case, wave: type[Wave], tmp_path: Path) -> Start:
    """Function that starts the program with a fault and a time limit."""
    write_record(tmp_path / "record.csv", wave().record(case_250), case_250.id)
    script = tmp_path / "a program.py"
    script.write_text(PROGRAM)

    def system(how: str, timeout: float = 20.0) -> System:
        text = f"{sys.executable} -S '{script}' '{how}' '{tmp_path}' '{tmp_path / 'log'}'"
        return choose_system(f"command:{text}", timeout)

    return system


def test_delivered_record_is_read(program: Start, case_250: Case, wave: type[Wave]) -> None:
    system = program("well")
    assert (system.name, system.version, system.kind) == ("p", "1", "command")
    begin = time.monotonic()
    outcome = system.run(case_250)
    assert 0 < outcome.run.wall_s <= time.monotonic() - begin
    assert_allclose(outcome.record.force, wave().record(case_250).force, rtol=1e-11)  # twelve digits in the file
    assert outcome.static == {"wave_speed_m_s": 121.7}
    assert outcome.notes[0] == "as asked"
    assert "has no case_digest" in outcome.notes[1]
    assert outcome.warnings == ()


def test_message_has_the_whole_case(program: Start, case_250: Case, tmp_path: Path) -> None:
    program("well").run(case_250)
    messages = [json.loads(line) for line in (tmp_path / "log").read_text().splitlines()][2:]
    assert [message["message"] for message in messages] == ["start", "run", "stop"]
    requests = jsonschema.Draft202012Validator(build_schema("command-request"))
    for message in messages:
        requests.validate(message)
    given = messages[1]["case"]
    text = json.dumps(given)
    for withheld in ("limit", "trust", "source", "note", "provisional"):
        assert f'"{withheld}"' not in text
    assert given["line"]["droppers"]["x_m"] == [5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0]
    assert given["line"]["contact_wire"]["tension_N"] == 20e3
    assert given["pantographs"][0]["chain"]["masses_kg"] == [15.0, 7.2]
    assert (given["pantographs"][0]["start_m"], given["pantographs"][0]["end_m"]) == (60.0, 420.0)
    assert given["evaluated_m"] == [240.0, 360.0]


@pytest.mark.parametrize(
    ("tables", "feature"),
    [
        ({"geometry": {"support": [{"number": 2, "encumbrance_m": 1.1}]}}, "single_supports"),
        ({"geometry": {"schedule": {"a": {"x_m": [9.0], "contact_wire_height_m": [0.0]}}}}, "surveyed_wire_heights"),
        ({"stitch_wire": {"length_m": 12.0, "tension_N": 2e3, "mass_kg_m": 0.3}}, "stitch_wire"),
    ],
)
def test_program_gets_no_line_that_it_does_not_simulate(
    program: Start, case_250: Case, tmp_path: Path, tables: dict[str, Any], feature: str
) -> None:
    """It would compute another line from the values that it knows."""
    line = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    line |= {key: line.get(key, {}) | table for key, table in tables.items()}
    outcome = program("well").run(replace(case_250, line=LineFile.model_validate(line)))
    assert outcome == Skipped(f"the system does not simulate {feature}")
    messages = [json.loads(line)["message"] for line in (tmp_path / "log").read_text().splitlines()]
    assert messages == ["start", "stop"] * 2


def test_program_without_features_gets_none(program: Start, case_250: Case, tmp_path: Path) -> None:
    outcome = program("no features").run(case_250)
    assert "the system does not list the features that it simulates" in outcome.reason
    messages = [json.loads(line)["message"] for line in (tmp_path / "log").read_text().splitlines()]
    assert messages == ["start", "stop"] * 2


@pytest.mark.parametrize(
    ("how", "verdict", "reason"),
    [
        ("skip", "skip", "no such line"),
        ("error", "error", "diverged at 1.2 s"),
        ("abort", "error", "p: was ended by SIGABRT before it answered"),
        ("garbage", "error", "p: its answer is not JSON: 'Reading licence ...' (write a log to the standard error)"),
        ("binary", "error", "p: its answer is not JSON"),
        ("partial", "error", 'p: ended in the middle of a line, after b\'{"message": "deliv\''),
        ("long line", "error", "p: wrote a line of more than 1000000 bytes"),
        ("flood", "error", "p: it answered 'run' with 'started'"),
        ("nan", "error", "finite number"),
        ("wrong id", "error", "p: its answer has the id 7; expected 1"),
        ("closes", "error", "p: closed its output before it answered"),
        ("outside", "error", "p: the file '../stray.toml' lies outside the folder of the run"),
        ("link", "error", "p: the file 'record.csv' lies outside the folder of the run"),
        ("absent", "error", "p: there is no file 'record.csv' in the folder of the run"),
        ("changed", "error", "p: the SHA-256 of the file 'record.csv' is not that of the answer"),
        ("late exit", "error", "p: ended with exit code 9 after its answer 'delivered'"),
        ("late crash", "error", "p: was ended by SIGSEGV after its answer 'delivered'"),
        ("late error", "error", "the licence ended"),
        ("other table", "error", "p: the sidecar names the table 'record.csv', the answer 'b.csv'"),
    ],
)
def test_fault_is_the_verdict_of_its_case(program: Start, case_250: Case, how: str, verdict: str, reason: str) -> None:
    try:
        (result,) = run_cases([case_250], program(how)).cases
    finally:
        Path(tempfile.gettempdir(), "stray.toml").unlink(missing_ok=True)
    assert result.verdict == verdict
    assert reason in result.reason
    assert "\n" not in result.reason


def test_record_must_name_its_case(program: Start, case_250: Case, tmp_path: Path, cases: list[Case]) -> None:
    """A record without a case may be of any run, although the program answers for this one."""
    first, second = run_cases(cases, program("crash")).cases
    assert (
        first.reason
        == "p: ended with exit code 1 before it answered; end of its standard error: no licence left; before it: line 3"
    )
    assert second.reason == "p: the record is of case 'en50318-2002/250'; expected 'en50318-2002/300'"
    system = program("well")
    edit_toml(tmp_path / "record.toml", {"case": None})
    assert system.run(case_250) == Errored("p: the record is of case None; expected 'en50318-2002/250'")


def running_processes(text: bytes) -> list[str]:
    processes = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if text in path.read_bytes():
                processes.append(path.parent.name)
        except OSError:
            continue
    return processes


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are counted in /proc")
def test_time_limit_ends_the_program_and_all_its_children(program: Start, case_250: Case) -> None:
    """One child stays in the process group of the program, the other starts a new session."""
    outcome = program("child", timeout=1.0).run(case_250)
    assert outcome == Errored("p: gave no answer within 1 s")
    assert not running_processes(b"time.sleep(1000)")


@pytest.mark.skipif(sys.platform != "linux", reason="orphans are adopted on Linux")
@pytest.mark.parametrize("how", ["daemon", "hang with daemon"])
def test_descendant_in_a_session_of_its_own_is_ended(program: Start, case_250: Case, how: str) -> None:
    outcome = program(how, timeout=20.0 if how == "daemon" else 1.0).run(case_250)
    assert isinstance(outcome, Delivered if how == "daemon" else Errored)
    assert not running_processes(b"time.sleep(1001)")


@pytest.mark.skipif(sys.platform != "linux", reason="the signal of the parent's end is of Linux")
def test_killed_process_ends_its_program(tmp_path: Path) -> None:
    """A worker that is killed cannot end its program; the kernel does."""
    code = (
        "import pathlib, sys; from pantocheck.conformance.runs.program import Program; "
        "program = Program([sys.executable, '-S', '-c', 'print(1, flush=True); import time; time.sleep(1002)'], "
        "pathlib.Path(sys.argv[1])); print(program.read_line(20.0), flush=True); import time; time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"b'1'\n"
        process.kill()
    wait_for_end(b"time.sleep(1002)")


def wait_for_end(text: bytes) -> None:
    limit = time.monotonic() + 5.0
    while running_processes(text):
        assert time.monotonic() < limit
        time.sleep(0.02)


@pytest.mark.skipif(sys.platform != "linux", reason="signals as on Linux")
@pytest.mark.parametrize(
    ("number", "jobs", "exit_code"),
    [
        (signal.SIGTERM, 1, 143),
        pytest.param(signal.SIGHUP, 1, 129, marks=pytest.mark.thorough),
        (signal.SIGINT, 2, 130),
    ],
)
def test_signal_to_the_main_process_keeps_results_and_ends_programs(
    case_250: Case, wave: type[Wave], tmp_path: Path, number: int, jobs: int, exit_code: int
) -> None:
    """The second case hangs; the first one is finished and must be in the results."""
    write_record(tmp_path / "record.csv", wave().record(case_250), case_250.id)
    script, log, out = tmp_path / "p.py", tmp_path / "log", tmp_path / "out"
    script.write_text(PROGRAM.replace('how == "hang"', 'how == "hang" and case.endswith("300")'))
    system = f"command:{sys.executable} -S '{script}' hang '{tmp_path}' '{log}'"
    # A parent such as nohup may ignore the signal, and its children inherit that.
    handler = "signal.default_int_handler" if number == signal.SIGINT else "signal.SIG_DFL"
    code = f"import signal; signal.signal({int(number)}, {handler})"
    command = [sys.executable, "-c", f"{code}; from pantocheck.conformance.app.main import start; start()", "run"]
    options = ["en50318-2002/*", "--system", system, "--out", str(out), "--formats", "json", "--jobs", str(jobs)]
    errors = tmp_path / "errors"
    with errors.open("wb") as file, subprocess.Popen([*command, *options, "--verbose"], stderr=file) as process:
        limit = time.monotonic() + 60.0
        while not (re.search("/250: (fail|info)", errors.read_text()) and '"en50318-2002/300"' in log.read_text()):
            assert time.monotonic() < limit
            time.sleep(0.05)
        start = time.monotonic()
        process.send_signal(number)
        try:
            process.wait(timeout=30)
        finally:
            process.kill()
        assert time.monotonic() - start < 10.0
    assert process.returncode == exit_code
    assert "Traceback" not in errors.read_text()
    assert not running_processes(str(script).encode())
    verdicts = {case.id: case.verdict for case in read_results(out / "results.json").cases}
    assert verdicts["en50318-2002/250"] not in ("skip", "error")
    assert verdicts["en50318-2002/300"] == "skip"


def test_deaf_program_is_ended_with_a_warning(program: Start, case_250: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pantocheck.conformance.runs.program.END_LIMIT", 0.2)
    outcome = program("deaf").run(case_250)
    assert outcome.warnings == ("p did not end after the message 'stop'; Pantocheck ended it",)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("slow start", "gave no answer within 1 s"),
        ("old", "it uses the protocol 'pantocheck.command/0'; expected 'pantocheck.command/1'"),
    ],
)
def test_program_that_does_not_start_is_an_error(program: Start, cases: list[Case], how: str, reason: str) -> None:
    results = run_cases(cases, program(how, timeout=1.0))
    assert [case.verdict for case in results.cases] == ["error", "error"]
    assert all(reason in case.reason for case in results.cases)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "the command is empty"),
        ("'", "cannot be split"),
        ("no-such-program --x", "there is no executable program 'no-such-program'"),
        ("./missing.sh", "there is no executable program './missing.sh'"),
        ("sh\0", "the command is empty"),
        ("python3 my_adapter.py --fast", "there is no file my_adapter.py in /"),
    ],
)
def test_invalid_command_is_refused(text: str, found: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=found):
        split_arguments(text, tmp_path)


def test_command_is_split_without_a_shell_and_relative_to_its_plan(tmp_path: Path) -> None:
    (tmp_path / "a b.py").touch()
    arguments = split_arguments("sh 'a b.py' $HOME ;rm -rf * | cat '' # x", tmp_path)
    assert arguments[1:] == (str(tmp_path / "a b.py"), "$HOME", ";rm", "-rf", "*", "|", "cat", "", "#", "x")
    assert os.path.isabs(arguments[0])
    (tmp_path / "ad apter.py").touch()
    (tmp_path / "plan.toml").write_text("system = \"command:sh 'ad apter.py'\"\n")
    system = read_plan(tmp_path / "plan.toml").system
    assert system.startswith("command:/")
    assert system.endswith(f"'{tmp_path}/ad apter.py'")


# Messages of a program: the key or the beginning of the line that is refused.


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
    jsonschema.validate(message, build_schema("command-answer"))
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
        ({"message": "skipped", "id": 1.5, "reason": "x"}, ": skipped.id: "),
        ({"message": "skipped", "id": 3}, ": skipped.reason: "),
        ({"message": "skipped", "id": 3, "reason": "\ud800"}, ""),
        ({}, "Unable to extract tag"),
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


def test_line_that_is_no_json_object_is_refused() -> None:
    for line in (b"[" * 100_000, b"\xff" * 10, b"9" * 5000, b"", b"\xff\xfe"):
        with pytest.raises(AnswerRefused, match="not JSON"):
            parse_message(line)
    for line in (b"[]", b"1"):
        with pytest.raises(AnswerRefused):
            parse_message(line)


@pytest.mark.parametrize(("length", "shown"), [(79, 79), (80, 80), (81, 80), (500, 80)])
def test_first_eighty_bytes_of_a_line_are_shown(length: int, shown: int) -> None:
    with pytest.raises(AnswerRefused) as caught:
        parse_message(b"x" * length)
    assert f"'{'x' * shown}'" in str(caught.value)
