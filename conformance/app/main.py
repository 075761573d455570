"""The `pantocheck` command."""

import atexit
import errno
import os
import signal
import sys
from types import FrameType
from typing import NoReturn

from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.commands.guard import FULL
from pantocheck.conformance.app.commands.output_settings import accept_all_characters
from pantocheck.conformance.core.processes import delay_garbage_searches, limit_threads


def start() -> None:
    """Run `main` as a process of its own, whose objects are not released one by one: a twentieth of `verify`."""
    exit_codes = list[int]()
    atexit.register(lambda: exit_codes and os._exit(exit_codes[0]))  # the first function here is called last
    atexit.register(print, end="", flush=True)
    try:
        main()
    except SystemExit as end:
        exit_codes.append(end.code if isinstance(end.code, int) else int(end.code is not None))
        raise


def main() -> None:
    """Run the `pantocheck` command."""
    delay_garbage_searches()
    # Plug-ins would be searched in every installed package, a tenth of the time of `check`.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    limit_threads()
    accept_all_characters()
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:  # nohup ignores SIGHUP
            signal.signal(number, _interrupt)
    exit_code: str | int | None = 0
    try:
        try:
            app(prog_name="pantocheck")
        except SystemExit as end:
            exit_code = end.code
        if sys.stdout is not None and not sys.stdout.closed:
            sys.stdout.flush()
    except OSError as error:
        if error.errno not in (*FULL, errno.EPIPE):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # the interpreter flushes again
        if error.errno in FULL:
            text = f"Standard output cannot be written ({error.strerror}).\n  Free space on the device."
            print(text, file=sys.stderr)
            exit_code = 2
    sys.exit(exit_code)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    """End a run as Ctrl-C does: finished work is kept, programs and processes are ended."""
    raise KeyboardInterrupt(number)
