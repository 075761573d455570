"""Client of a time-stamp server (RFC 3161)."""

import urllib.request
from http.client import HTTPException
from typing import Any
from urllib.error import HTTPError
from urllib.parse import urlsplit

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.page_text import clean_text

LONGEST_WAIT_S = 30.0
"""Longest wait for an answer of the server [s]."""

MAX_ANSWER_BYTES = 2**20
"""Largest answer that is read [bytes]; a time stamp with its certificates has about ten thousand."""


def build_timestamp_client(url: str) -> Any:
    """Client of the time-stamp server at an address.

    Args:
        url: Address of the server, http or https.

    Returns:
        Client whose requests fail with `InputError` (pyhanko.sign.timestamps.TimeStamper).

    Raises:
        InputError: The address is not one of http or https.
    """
    from asn1crypto import tsp
    from pyhanko.sign.timestamps import TimeStamper

    where = f"time-stamp server {clean_text(url)}"
    if urlsplit(url).scheme not in ("http", "https") or not urlsplit(url).hostname:
        raise InputError(where, "not an address of a server", "Give an address as https://tsa.example.org/tsr.")

    class Client(TimeStamper):  # type: ignore[misc]  # the base class is known only when the package is installed
        """Client that sends a request by HTTP."""

        async def async_request_tsa_response(self, req: Any) -> Any:
            """Answer of the server to a request."""
            try:
                response = tsp.TimeStampResp.load(_post(url, req.dump(), where), strict=True)
                granted = response["status"]["status"].native == "granted"
                stamp = response["time_stamp_token"]["content"]["encap_content_info"]["content"].parsed
                fits = all(stamp[key].dump() == req[key].dump() for key in ("message_imprint", "nonce"))
            except InputError:
                raise
            except (ValueError, TypeError, KeyError, AttributeError):
                granted = fits = False
            if not (granted and fits):
                found = "its time stamp belongs to another request" if granted else "it answered without a time stamp"
                raise InputError(where, found, "Check the address of the server, or use another one.")
            return response

    return Client()


def _post(url: str, request: bytes, where: str) -> bytes:
    headers = {"Content-Type": "application/timestamp-query", "Accept": "application/timestamp-reply"}
    message = urllib.request.Request(url, request, headers)
    try:
        with urllib.request.urlopen(message, timeout=LONGEST_WAIT_S) as answer:
            return bytes(answer.read(MAX_ANSWER_BYTES))
    except (OSError, HTTPException, ValueError) as error:
        if isinstance(error, HTTPError):
            error.close()
        reason = clean_text(str(getattr(error, "reason", "") or error))
        raise InputError(where, f"gave no time stamp ({reason})", "Check the address and the network.") from None
