"""`pantocheck cases`: what there is to run."""


def cases_command() -> None:
    """List the cases of the library: id, title, and how many limits of which trust each has."""
    from collections import Counter

    from rich.table import Table

    from pantocheck.conformance.cases.library import library_folder, list_library, load_case
    from pantocheck.conformance.command_line.console import console, escape_text
    from pantocheck.conformance.input_files.trust import LEVELS

    table = Table("case", "title", "limits", box=None, pad_edge=False, header_style="bold")
    for path in list_library(library_folder()).values():
        case = load_case(path)
        trusts = Counter(limit.trust for limit in case.limits)
        limits = ", ".join(f"{trusts[level]} {level}" for level in LEVELS if trusts[level]) or "none: informative"
        table.add_row(escape_text(case.id), escape_text(case.file.title), limits)
    console().print(table)
