"""Check of the measured and simulated tables of a dossier: each is read as its step reads it, without a simulation."""

from collections.abc import Callable, Iterator
from functools import partial

from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.dossier.dossier_file import RecordRun
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.line_test_step import build_line_test_profile
from pantocheck.conformance.dossier.run_reading import read_run
from pantocheck.conformance.pantograph.response_record import read_response


def check_documents(dossier: Dossier) -> int:
    """Read every table of a dossier.

    Args:
        dossier: Dossier with its files.

    Returns:
        Number of tables.

    Raises:
        InputError: A table cannot be read as its kind; the error lists the problems of all tables.
    """
    problems: list[InputError] = []
    readers = [*_list_readers(dossier)]
    for key, read in readers:
        try:
            read()
        except InputError as error:
            problems.extend(
                InputError(f"dossier, key {key}: {problem.where}", problem.found, problem.hint)
                for problem in error.problems
            )
    if problems:
        raise join_errors(problems)
    return len(readers)


def _list_readers(dossier: Dossier) -> Iterator[tuple[str, Callable[[], object]]]:
    """Key of every table, and the function that reads it."""
    for i, pantograph in enumerate(dossier.file.pantograph, 1):
        for k, name in enumerate(pantograph.responses, 1):
            yield f"pantograph[{i}].responses[{k}]", partial(read_response, dossier.locate(name))
    for i, line in enumerate(dossier.file.line, 1):
        if line.statics is not None:
            geometry = dossier.lines[line.name].geometry
            yield f"line[{i}].statics", partial(read_static_record, dossier.locate(line.statics), geometry)
    profile = build_line_test_profile(dossier.file.line_test)
    for i, pair in enumerate(dossier.file.pair, 1):
        for key, run in (("simulated", pair.simulated), ("measured", pair.measured)):
            if isinstance(run, RecordRun):
                yield f"pair[{i}].{key}.record", partial(read_run, run, dossier, profile)
