"""Package for signatures: pyHanko, which the extra `sign` installs."""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from pantocheck.conformance.input_files.extras import refuse_missing_package

Result = TypeVar("Result")


def run_apart(function: Callable[[], Result]) -> Result:
    """Run a function in a thread of its own: pyHanko starts an event loop, and a notebook has a running one already."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(function).result()


@contextmanager
def use_signature_package() -> Iterator[None]:
    """Import and use pyHanko inside a block, without its log, which repeats failures with tracebacks.

    Raises:
        InputError: The package is not installed.
    """
    log = logging.getLogger("pyhanko")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        with refuse_missing_package("a signature"):
            yield
    finally:
        log.setLevel(level)
