"""Server of the explorer: who is answered, which requests are refused, and that the newest one wins."""

import http.client
import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from pantocheck.conformance.app.commands.explore_command import open_explorer
from pantocheck.conformance.app.explorer import explored_case
from pantocheck.conformance.app.explorer.explore_server import LARGEST_REQUEST, TOKEN_HEADER, ExploreServer
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import list_library, load_case, select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.model.description.failures import SimulationError

CASE = "en50318-2002/250"


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ExploreServer]:
    """A running explorer with a folder for saved settings."""
    explored, page, folder = open_explorer(CASE, (), (), tmp_path / "saved")
    running = ExploreServer(explored, page, folder)
    thread = threading.Thread(target=running.serve_forever, daemon=True)
    thread.start()
    yield running
    running.shutdown()
    running.server_close()
    thread.join()


def ask(
    server: ExploreServer, path: str, content: object = None, method: str = "POST", **headers: str | None
) -> tuple[int, Any, http.client.HTTPMessage]:
    """Status, content and headers of an answer; a header with the value None is left out."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    stated: dict[str, str | None] = {"Content-Type": "application/json", TOKEN_HEADER: server.token}
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    given = stated | {name.replace("_", "-"): value for name, value in headers.items()}
    kept = {name: value for name, value in given.items() if value is not None}
    connection.request(method, path, body if method == "POST" else None, kept)
    answer = connection.getresponse()
    text = answer.read()
    connection.close()
    is_json = answer.headers.get_content_type() == "application/json"
    return answer.status, json.loads(text) if is_json else text.decode(), answer.headers


def test_page_is_sent_to_the_holder_of_the_token(server: ExploreServer) -> None:
    status, page, headers = ask(server, f"/?token={server.token}", method="GET")
    assert status == 200
    assert "Nothing on this page is a certificate" in page
    assert "connect-src &#39;self&#39;" in page or "connect-src 'self'" in page
    assert (headers["Referrer-Policy"], headers["X-Frame-Options"]) == ("no-referrer", "DENY")
    assert server.token not in page
    for path in ("/", "/?token=", f"/?token={server.token[:-1]}", f"/?token={server.token}x", "/?token=%C3%A9"):
        assert ask(server, path, method="GET")[0] == 403
    assert ask(server, f"/other?token={server.token}", method="GET")[0] == 404


@pytest.mark.parametrize(
    "headers",
    [
        {"X_Pantocheck_Token": None},
        {"X_Pantocheck_Token": "wrong"},
        {"Host": "attacker.example:80"},
        {"Host": "127.0.0.1"},
        {"Origin": "http://attacker.example"},
        {"Origin": "null"},
    ],
)
def test_requests_of_others_are_refused(server: ExploreServer, headers: dict[str, str | None]) -> None:
    status, answer, _ = ask(server, "/simulate", {"values": {}}, **headers)
    assert status == 403
    assert answer["problem"].endswith("Open the address again that the command has printed.")


def test_own_origin_is_accepted(server: ExploreServer) -> None:
    origin = f"http://127.0.0.1:{server.server_port}"
    assert ask(server, "/motion", {"number": -1}, Origin=origin)[0] == 409  # no such setting, but an answer


@pytest.mark.parametrize(
    ("path", "content", "status", "problem"),
    [
        ("/simulate", {"values": {}, "speed": 1}, 400, "key speed: extra inputs are not permitted"),
        ("/simulate", {"values": {"speed_km_h": "fast"}}, 400, "should be a valid number"),
        ("/simulate", {"values": {"speed_km_h": 1e30}}, 400, "less than or equal"),
        ("/simulate", {"values": {"speed_km_h": 1000.0}}, 400, "Choose 125 to 375 km/h."),
        ("/simulate", {"values": {"limit": 1.0}}, 400, "is not on this page"),
        ("/simulate", [], 400, "key top level"),
        ("/simulate", b"{", 400, "is not valid JSON"),
        ("/simulate", b" " * (LARGEST_REQUEST + 1), 413, "larger than"),
        ("/other", {}, 404, "no such request"),
        ("/case", {"values": {}, "name": "../x"}, 400, "cannot be used"),
        ("/campaign", {"values": {}, "name": "x", "varied": "x", "first": 1, "last": 2, "count": 3}, 400, "slider 'x'"),
    ],
)
def test_wrong_requests_end_in_one_sentence(
    server: ExploreServer, path: str, content: object, status: int, problem: str
) -> None:
    found, answer, _ = ask(server, path, content)
    assert (found, problem in answer["problem"]) == (status, True), answer
    assert "\n" not in answer["problem"]
    assert "Traceback" not in answer["problem"]


def test_length_and_kind_of_a_request_are_demanded(server: ExploreServer) -> None:
    assert ask(server, "/simulate", {"values": {}}, Content_Type="text/plain")[0] == 415
    assert ask(server, "/simulate", {"values": {}}, Transfer_Encoding="chunked")[0] == 411
    assert ask(server, "/simulate", {"values": {}}, Content_Length="-1")[0] == 411


def test_values_are_those_of_the_simulator_to_the_last_bit(server: ExploreServer) -> None:
    """The answer passes through JSON, which keeps every bit of a number; limits are those of the unchanged case."""
    status, answer, _ = ask(server, "/simulate", {"values": {"speed_km_h": 285.0, "pantograph.uplift_force_N": 130.0}})
    assert status == 200
    texts = ["speed_km_h=285", "pantograph.uplift_force_N=130"]
    case = load_case(list_library(library_folder())[CASE], parse_changes(texts))
    values = CaseEvaluation(case, ReferenceSimulator().run_unrefined(case)).evaluation.values
    found = {(row["pantograph"], row["quantity"]): row["value"] for row in answer["criteria"]}
    assert len(found) > 10
    assert found == {(owner, name): values[owner][name] for owner, name in found}
    limits = {limit.target[:2]: (limit.lower, limit.upper) for limit in select_cases([CASE])[-1].limits}
    rows = [row for row in answer["criteria"] if row["lower"] is not None or row["upper"] is not None]
    assert {(row["quantity"], row["pantograph"]): (row["lower"], row["upper"]) for row in rows} == limits
    for row in rows:
        assert row["is_inside"] == (row["lower"] <= row["value"] <= row["upper"])
    assert answer["command"] == f"pantocheck run {CASE} --set speed_km_h=285.0 --set pantograph.uplift_force_N=130.0"
    status, motion, _ = ask(server, "/motion", {"number": answer["number"]})
    assert status == 200
    assert motion["speed_m_s"] == pytest.approx(285 / 3.6)
    assert "verdict" not in json.dumps(answer)


def test_newest_request_wins(server: ExploreServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first passage runs until the second request is there, and ends early; the second is answered."""
    begun, count = threading.Event(), []
    simulate = ReferenceSimulator.run_unrefined

    def wait(self: ReferenceSimulator, case: Any, follow: Any) -> Any:
        count.append(case.file.speed_km_h)
        begun.set()
        if len(count) > 1:
            return simulate(self, case, follow)
        limit = time.monotonic() + 60
        while time.monotonic() < limit:
            follow(0.5)
            time.sleep(0.01)
        raise AssertionError("the first request was not ended")

    monkeypatch.setattr(explored_case.ReferenceSimulator, "run_unrefined", wait)
    found: dict[float, int] = {}

    def request(speed: float) -> None:
        found[speed] = ask(server, "/simulate", {"values": {"speed_km_h": speed}})[0]

    first = threading.Thread(target=request, args=(200.0,))
    first.start()
    assert begun.wait(30)
    begun.clear()
    request(300.0)
    first.join(30)
    assert found == {200.0: 409, 300.0: 200}
    assert count == [200.0, 300.0]


def test_failed_simulation_is_one_sentence(server: ExploreServer, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise SimulationError("no static equilibrium:\n the droppers are slack")

    monkeypatch.setattr(explored_case.ReferenceSimulator, "run_unrefined", fail)
    status, answer, _ = ask(server, "/simulate", {"values": {}})
    assert (status, answer["problem"]) == (
        422,
        "The simulation failed: no static equilibrium: the droppers are slack",
    )


def test_port_in_use_is_named(server: ExploreServer) -> None:
    with pytest.raises(InputError, match=f"port {server.server_port}"):
        ExploreServer(server.explored, "", None, server.server_port)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("en50318-2002/*", "expected one case with a train, found en50318-2002/250, en50318-2002/300"),
        ("en50318-2018/ac-simple/static", "found none"),
        ("none.toml", "none.toml"),
    ],
)
def test_explorer_needs_one_case_with_a_train(name: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        open_explorer(name, (), (), None)
    assert message in str(error.value)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for a single process")
def test_command_prints_its_address_and_ends_with_ctrl_c() -> None:
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # the parent may ignore it
    code += "; from pantocheck.conformance.app.main import main; main()"
    command = [sys.executable, "-c", code, "explore", CASE]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        address = urlsplit(process.stderr.readline().strip())
        connection = http.client.HTTPConnection("127.0.0.1", address.port, timeout=60)
        connection.request("GET", f"/?{address.query}")
        assert connection.getresponse().status == 200
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    assert (process.returncode, output) == (0, "explorer ended, 0 saved settings\n")
