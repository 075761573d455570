"""Connection to a running scheduler of Dask."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError

CONNECTION_TIMEOUT_S = 30
"""Time after which a scheduler that does not answer is given up [s]."""


@contextmanager
def connect_client(address: str, purpose: str) -> Iterator[Any]:
    """Connect to a running scheduler, such as `tcp://host:8786`.

    Args:
        address: Address of the scheduler.
        purpose: Command or input that needs the package, for messages.

    Raises:
        InputError: Dask is not installed, or the scheduler cannot be reached.
    """
    with refuse_missing_package(purpose):
        import distributed
    try:
        client = distributed.Client(address, timeout=CONNECTION_TIMEOUT_S)
    except (OSError, ValueError) as error:
        found = f"cannot be reached ({' '.join(str(error).split())[:200]})"
        raise InputError(f"scheduler '{address}'", found, "Start one with `dask scheduler`.") from None
    with client:
        yield client
