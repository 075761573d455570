"""Server of the explorer: one page and its requests on the loopback address, for the holder of a token alone.

==================  ================================================================================================
danger              refusal
==================  ================================================================================================
other program       a random token in the address of the page and in a header of every request, compared in constant
                    time
other page          a request needs a header that other origins may send only with a permission, which is never given;
                    a stated origin must be the server itself
another name        the header Host must be the loopback address of the server: a name that leads here (DNS rebinding)
                    is refused
large request       a request has a stated length of at most `LARGEST_REQUEST`, and a time limit
==================  ================================================================================================
"""

import secrets
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import parse_qs, urlsplit

from pydantic import Field, TypeAdapter

from pantocheck.conformance.app.explorer.explored_case import ExploredCase, Superseded
from pantocheck.conformance.app.explorer.saved_settings import save_campaign, save_case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import parse_json, validate_json
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart

ADDRESS = "127.0.0.1"

LARGEST_REQUEST = 20_000
"""Largest size of a request [bytes]; a setting of the sliders has about 1,000."""

TIME_LIMIT_S = 10.0
"""Time in which the next bytes of a request have to arrive [s]."""

TOKEN_HEADER = "X-Pantocheck-Token"

HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}

OPEN_AGAIN = "Open the address again that the command has printed."


class SettingRequest(ResultsPart):
    """Setting of the sliders."""

    values: Annotated[dict[str, FiniteNumber], Field(max_length=100)]


class MotionRequest(ResultsPart):
    """Request of the moving picture of a simulated setting."""

    number: int


class CaseRequest(SettingRequest):
    """Request to save a case."""

    name: str


class CampaignRequest(CaseRequest):
    """Request to save a campaign that varies one slider."""

    varied: str
    first: FiniteNumber
    last: FiniteNumber
    count: int


class ExploreServer(ThreadingHTTPServer):
    """Server of one explored case."""

    daemon_threads = True

    def __init__(self, explored: ExploredCase, page: str, folder: Path | None, port: int = 0) -> None:
        """Listen on the loopback address.

        Args:
            explored: Explored case.
            page: Page of the case.
            folder: Folder for saved settings; None: nothing is saved.
            port: Port; 0: any free one.

        Raises:
            InputError: The port is not free.
        """
        self.explored, self.page, self.folder = explored, page.encode(), folder
        self.token = secrets.token_urlsafe(32)
        self.saved: list[Path] = []
        try:
            super().__init__((ADDRESS, port), ExploreHandler)
        except (OSError, OverflowError) as error:
            raise InputError(f"port {port}", f"cannot be used ({error})", "Name another --port, or none.") from None
        self.hosts = {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    @property
    def address(self) -> str:
        """Address of the page with its token."""
        return f"http://{ADDRESS}:{self.server_port}/?token={self.token}"

    def accepts(self, token: str) -> bool:
        """Whether a token is that of this server."""
        return secrets.compare_digest(token.encode("utf-8", "surrogateescape"), self.token.encode())

    def server_close(self) -> None:
        """End a running computation, and close the port."""
        self.explored.stop()
        super().server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a connection that the page has closed."""


class ExploreHandler(BaseHTTPRequestHandler):
    """One request."""

    server: ExploreServer
    timeout = TIME_LIMIT_S
    server_version, sys_version = "pantocheck", ""

    def do_GET(self) -> None:
        """Send the page."""
        place = urlsplit(self.path)
        tokens = parse_qs(place.query).get("token", [""])
        if refusal := self._refuse(tokens[0]):
            self._send_problem(HTTPStatus.FORBIDDEN, refusal)
        elif place.path != "/":
            self._send_problem(HTTPStatus.NOT_FOUND, "There is no such page.")
        else:
            self._send(HTTPStatus.OK, "text/html; charset=utf-8", self.server.page)

    def do_POST(self) -> None:
        """Answer a request of the page."""
        if refusal := self._refuse(self.headers.get(TOKEN_HEADER, "")):
            self._send_problem(HTTPStatus.FORBIDDEN, refusal)
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or "Transfer-Encoding" in self.headers:
            self._send_problem(HTTPStatus.LENGTH_REQUIRED, "The request states no length.")
        elif len(length) > 9 or int(length) > LARGEST_REQUEST:
            text = f"The request is larger than {LARGEST_REQUEST} bytes."
            self._send_problem(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, text)
        elif self.headers.get_content_type() != "application/json":
            self._send_problem(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "The request is not JSON.")
        elif (answer := REQUESTS.get(self.path)) is None:
            self._send_problem(HTTPStatus.NOT_FOUND, "There is no such request.")
        else:
            self._answer(answer, self.rfile.read(int(length)))

    def _refuse(self, token: str) -> str | None:
        """Reason to refuse a request; None: it comes from the page of this server."""
        origin, host = self.headers.get("Origin"), self.headers.get("Host", "")
        if host not in self.server.hosts:
            return f"The request names another host. {OPEN_AGAIN}"
        if origin is not None and origin not in {f"http://{name}" for name in self.server.hosts}:
            return f"The request comes from another page. {OPEN_AGAIN}"
        return None if self.server.accepts(token) else f"The request has no valid token. {OPEN_AGAIN}"

    def _answer(self, answer: "RequestKind", body: bytes) -> None:
        try:
            request = validate_json(parse_json(body, "request", LARGEST_REQUEST), answer.model, "request", OPEN_AGAIN)
            text = answer.act(self.server, request)
        except Superseded:
            self._send_problem(HTTPStatus.CONFLICT, "A newer request has replaced this one.")
        except InputError as error:
            self._send_problem(HTTPStatus.BAD_REQUEST, " ".join(error.problems[0].message.split()))
        except Exception as error:  # a failure of the model, or a defect: the page goes on
            text = " ".join(str(error).split())[:300]
            self._send_problem(HTTPStatus.UNPROCESSABLE_ENTITY, f"The simulation failed: {text}")
        else:
            self._send(HTTPStatus.OK, "application/json", text.encode())

    def _send_problem(self, status: HTTPStatus, text: str) -> None:
        self._send(status, "application/json", Problem(problem=text).model_dump_json().encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        """Send an answer; the connection ends with it, so that the rest of a refused request is not read."""
        self.close_connection = True
        self.send_response(status)
        for name, value in {"Content-Type": kind, "Content-Length": str(len(content)), **HEADERS}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Write no log: it would hold the token."""


class Problem(ResultsPart):
    """Answer to a refused request."""

    problem: str


class Saved(ResultsPart):
    """Answer to a request to save a setting."""

    file: str
    command: str
    """Command that takes the file."""


@dataclass(frozen=True)
class RequestKind:
    """Kind of a request: its content, and the function that gives the JSON text of its answer."""

    model: TypeAdapter[Any]
    act: Callable[[ExploreServer, Any], str]


def _simulate(server: ExploreServer, request: SettingRequest) -> str:
    return server.explored.simulate(request.values).model_dump_json()


def _build_motion(server: ExploreServer, request: MotionRequest) -> str:
    motion = server.explored.build_motion(request.number)
    return "null" if motion is None else motion.model_dump_json()


def _save_case(server: ExploreServer, request: CaseRequest) -> str:
    path = save_case(server.explored, request.values, _find_folder(server), request.name)
    return _note(server, path, "run")


def _save_campaign(server: ExploreServer, request: CampaignRequest) -> str:
    varied = (request.varied, (request.first, request.last, float(request.count)))
    path = save_campaign(server.explored, request.values, _find_folder(server), request.name, varied)
    return _note(server, path, "campaign")


def _find_folder(server: ExploreServer) -> Path:
    if server.folder is None:
        raise InputError("folder", "no folder for saved settings is named", "Start the command with --out FOLDER.")
    return server.folder


def _note(server: ExploreServer, path: Path, command: str) -> str:
    server.saved.append(path)
    return Saved(file=str(path), command=shlex.join(("pantocheck", command, str(path)))).model_dump_json()


REQUESTS: Mapping[str, RequestKind] = {
    "/simulate": RequestKind(TypeAdapter(SettingRequest), _simulate),
    "/motion": RequestKind(TypeAdapter(MotionRequest), _build_motion),
    "/case": RequestKind(TypeAdapter(CaseRequest), _save_case),
    "/campaign": RequestKind(TypeAdapter(CampaignRequest), _save_campaign),
}
"""Requests of the page by their paths."""
