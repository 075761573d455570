"""Results that depend on the line alone: built once per line and shared by all its simulations."""

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from pantocheck.model.discretised_line import DiscretisedLine

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def keep_with_line(
    build: Callable[Concatenate[DiscretisedLine, Arguments], Result],
) -> Callable[Concatenate[DiscretisedLine, Arguments], Result]:
    """Keep the results of a function with the line, so that each is built once and lives as long as the line.

    Args:
        build: Function of a line and of hashable positional arguments. Its result must not be changed by those who
            share it.

    Returns:
        The same function; equal arguments give the same object.
    """

    @wraps(build)
    def look_up(line: DiscretisedLine, /, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        key = (build, args, *kwargs.items())
        if key not in line.kept:
            line.kept[key] = build(line, *args, **kwargs)
        kept: Result = line.kept[key]
        return kept

    return look_up
