"""`pantocheck cases`: what there is to run."""


def cases() -> None:
    """List the cases of the library: id, title, and how many limits of which trust each has."""
    from collections import Counter

    from rich.table import Table

    from pantocheck.conformance.cases.library import library_folder, library_ids, load
    from pantocheck.conformance.command_line.console import console, plain
    from pantocheck.conformance.input_files.trust import LEVELS

    table = Table("case", "title", "limits", box=None, pad_edge=False, header_style="bold")
    for path in library_ids(library_folder()).values():
        case = load(path)
        trusts = Counter(limit.trust for limit in case.limits)
        limits = ", ".join(f"{trusts[level]} {level}" for level in LEVELS if trusts[level]) or "none: informative"
        table.add_row(plain(case.id), plain(case.file.title), limits)
    console().print(table)
