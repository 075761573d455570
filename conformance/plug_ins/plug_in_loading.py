"""Loading of plug-ins, and failures inside their code: each message names the distribution."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import EntryPoint
from typing import TypeVar

from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.plug_ins.plug_in import GROUPS, PlugIn

T = TypeVar("T")


def load_plug_in(plug_in: PlugIn, expected: type[T]) -> T:
    """Import the object of a plug-in, and check its type.

    Parameters
    ----------
    plug_in : PlugIn
        Entry point.
    expected : type
        Required type of the object.

    Raises
    ------
    InputError
        It cannot be imported, or is of another type.
    """
    with guard_plug_in(plug_in):
        loaded = EntryPoint(plug_in.name, plug_in.value, GROUPS[plug_in.kind]).load()
    if not isinstance(loaded, expected):
        raise InputError(
            plug_in.text,
            f"{plug_in.value} is a {type(loaded).__name__}",
            f"It must be a pantocheck.conformance.{expected.__name__}. See {DocumentationPage.EXTENDING}.",
        )
    return loaded


@contextmanager
def guard_plug_in(plug_in: PlugIn) -> Iterator[None]:
    """Convert an exception inside the code of a plug-in into `InputError` that names its distribution."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{plug_in.text}, {error.where}", error.found, error.hint) from None
    except (Exception, SystemExit) as error:
        text = " ".join(f"{type(error).__name__}: {error}".split())[:300]
        raise InputError(
            plug_in.text, f"failed ({text})", f"Report it to the authors of {plug_in.distribution}, or uninstall it."
        ) from None
