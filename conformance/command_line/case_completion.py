"""Shell completion of the ids of cases."""

from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.library_list import list_library


def complete_case(incomplete: str) -> list[str]:
    """Ids of the library that begin with the typed text; the shell completes paths of case files."""
    return [name for name in list_library(library_folder()) if name.startswith(incomplete)]
