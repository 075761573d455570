"""Input errors. The table lists the steps in which input is used, and the exception of each step.

================================  ==================================  ==============================================
step                              exception                           result
================================  ==================================  ==============================================
open, parse and validate a file   `InputError`                        message of the command line, exit code 2
build a record from samples       `RecordInvalid`                     `InputError` of the table (`record_reading`)
compute a quantity                `QuantityUnavailable`               criterion with the verdict `skip`
evaluate the rule of a profile    `BoundMissing`                      criterion with the verdict `skip`
start an external program         `ProgramFailed`                     case with the verdict `error`
read the answer of a program      `AnswerRefused`                     case with the verdict `error`
read the files of a program       `DeliveryRefused`, `InputError`     case with the verdict `error`
tune and simulate a line          `SimulationError`                   message of the command line, exit code 2
================================  ==================================  ==============================================

In a run of several cases, the first and the last end as the verdict `error` of their case.
"""

from collections.abc import Sequence
from difflib import get_close_matches

MOST_MESSAGES = 50
"""Largest number of messages in the text of an error; further ones are counted."""


class InputError(ValueError):
    """Input that cannot be used. It is refused, because wrong input would give a wrong number in a certificate.

    Args:
        where: File, and the key, line or channel inside it.
        found: Content found there.
        hint: Content expected there, or the next step of the user.
        further: Further errors of the same input.
    """

    def __init__(self, where: str, found: str, hint: str, further: Sequence["InputError"] = ()) -> None:
        self.where = where
        self.found = found
        self.hint = hint
        self.further = tuple(further)
        messages = [error.message for error in self.problems]
        more = len(messages) - MOST_MESSAGES
        counted = [f"... and {more} more. Correct these first."] if more > 0 else []
        super().__init__("\n".join([*messages[:MOST_MESSAGES], *counted]))

    @property
    def message(self) -> str:
        """Text of this error, without further errors."""
        return f"{self.where}: {self.found}.\n  {self.hint}"

    @property
    def problems(self) -> tuple["InputError", ...]:
        """This error and all further ones."""
        return (self, *(problem for error in self.further for problem in error.problems))


def join_errors(errors: Sequence[InputError]) -> InputError:
    """One error that reports several, in their order and each once."""
    problems = {problem.message: problem for error in errors for problem in error.problems}
    first, *others = (InputError(problem.where, problem.found, problem.hint) for problem in problems.values())
    return InputError(first.where, first.found, first.hint, others)


# Suggestions for an unknown name.
def suggest_names(name: str, known: Sequence[str], prefix: str = "") -> str:
    """Sentence with the known names that resemble an unknown name, behind a prefix, or with the first known names."""
    # Users often write the last part of an id only.
    tails = {item.rsplit("/", 1)[-1]: item for item in known}
    lowered = {item.lower(): item for item in known}
    # A typing error has one near match; weaker matches are offered as a choice.
    close = get_close_matches(name.lower(), list(lowered), n=1, cutoff=0.9) or get_close_matches(
        name.lower(), list(lowered), n=3, cutoff=0.5
    )
    close = [lowered[match] for match in close]
    if not close and name in tails:
        close = [tails[name]]
    if close:
        return f"Did you mean {' or '.join(prefix + item for item in close)} ?"
    if not known:
        return "None are known."
    return f"Known are: {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}"
