"""Log of a command on standard error: records of the loggers `pantocheck.*`, with `--verbose`."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from rich.text import Text

from pantocheck.conformance.app.commands.console import error_console
from pantocheck.conformance.app.commands.guard import strip_control_characters
from pantocheck.conformance.app.commands.output_settings import current_settings

ROOT_LOGGER = "pantocheck"


class _ErrorLog(logging.Handler):
    """Handler that prints above a line of progress, if there is one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record without control characters."""
        errors = error_console()
        # Outside of a terminal a line stays whole, for a search in a log.
        errors.print(Text(strip_control_characters(self.format(record))), soft_wrap=not errors.is_terminal)


@contextmanager
def write_log() -> Iterator[None]:
    """Print the log while a command runs, if the current settings ask for details."""
    if current_settings().detail != "verbose":
        yield
        return
    logger, handler = logging.getLogger(ROOT_LOGGER), _ErrorLog(logging.INFO)
    handler.setFormatter(logging.Formatter("%(asctime)s %(name)s: %(message)s", "%H:%M:%S"))
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(min(logging.INFO, level or logging.INFO))
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
