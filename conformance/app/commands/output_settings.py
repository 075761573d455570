"""Settings of the output of every command: amount, form and colour."""

import codecs
import inspect
import os
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from io import TextIOWrapper
from typing import Annotated, Literal

import typer

FLAGS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "verbose": (("--verbose", "-v"), "Print details, and the steps to standard error."),
    "quiet": (("--quiet", "-q"), "Print only errors and the verdict line."),
    "json": (("--json",), "Print the result as one JSON object, for programs."),
    "no_color": (("--no-color",), "Print without colour and bold text."),
}
"""Options of the output by name: their forms and their help."""


Detail = Literal["quiet", "normal", "verbose"]
"""Amount of text of an output."""


@dataclass(frozen=True)
class OutputSettings:
    """Settings of the output of a command."""

    detail: Detail = "normal"
    """Amount of text."""
    form: Literal["text", "json"] = "text"
    """Text for a reader, or JSON for a program."""
    colour: Literal["automatic", "none"] = "automatic"
    """Colour and bold text on a terminal, or none."""


DEFAULT_SETTINGS = OutputSettings()

_CURRENT: ContextVar[OutputSettings] = ContextVar("output_settings", default=DEFAULT_SETTINGS)


def current_settings() -> OutputSettings:
    """Settings of the command that runs; the default settings outside of a command."""
    return _CURRENT.get()


@contextmanager
def use_settings(settings: OutputSettings) -> Iterator[None]:
    """Make settings the current ones."""
    token = _CURRENT.set(settings)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def combine_flags(given: Collection[str]) -> OutputSettings:
    """Settings of the given options of `FLAGS`; more and less output at once are refused."""
    if {"verbose", "quiet"} <= set(given):
        raise typer.BadParameter("-v and -q contradict each other. Give one of them.")
    return OutputSettings(
        detail="quiet" if "quiet" in given else "verbose" if "verbose" in given else "normal",
        form="json" if "json" in given else "text",
        colour="none" if "no_color" in given or os.environ.get("NO_COLOR") else "automatic",
    )


def list_given(flags: Mapping[str, bool]) -> frozenset[str]:
    """Names of the given options."""
    return frozenset(name for name, given in flags.items() if given)


def add_flags(function: Callable[..., None], visibility: Literal["shown", "hidden"]) -> Callable[..., None]:
    """Let a function with `**flags` declare the options of the output to typer.

    The help of `pantocheck` lists them, that of a command refers to it.
    """
    signature = inspect.signature(function)
    own = [parameter for parameter in signature.parameters.values() if parameter.kind is not parameter.VAR_KEYWORD]
    flags = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=False,
            annotation=Annotated[bool, typer.Option(*forms, help=text, hidden=visibility == "hidden")],
        )
        for name, (forms, text) in FLAGS.items()
    ]
    function.__signature__ = signature.replace(parameters=[*own, *flags])  # type: ignore[attr-defined]
    return function


# Output on terminals whose encoding lacks characters, such as Windows-1252 or ASCII.
REPLACEMENTS = {
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "−": "-",
    "–": "-",
    "—": "-",
    "…": "...",
    "×": "x",
    "µ": "u",
    "μ": "u",
    "°": "deg",
    "²": "^2",
    "³": "^3",
    "·": "*",
    "→": "->",
    "✓": "+",
    "✗": "x",
}
"""Symbols of the suite in ASCII; a space becomes a blank, any other character a question mark."""

ERROR_HANDLER = "pantocheck.symbols"


def replace_symbols(error: UnicodeError) -> tuple[str, int]:
    """Replacement of characters that an encoding lacks, as an error handler of `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    return "".join(REPLACEMENTS.get(character, " " if character.isspace() else "?") for character in text), error.end


def accept_all_characters() -> None:
    """Let standard output and standard error replace characters that their encoding lacks.

    Without it, a title with a Greek letter would end a command on such a terminal.
    """
    codecs.register_error(ERROR_HANDLER, replace_symbols)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors=ERROR_HANDLER)
