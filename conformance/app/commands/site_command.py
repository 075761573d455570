"""`pantocheck site`: a static site of many results."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import indent_text
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.pages.report_writers import write_pages, write_report
from pantocheck.conformance.pages.site_pages import build_case_page, build_site_index, name_file, order_results
from pantocheck.conformance.results.report_files import FILES
from pantocheck.conformance.results.results_reading import read_results

MOST_RESULTS = 2000
"""Largest number of results on a site."""


def site_command(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR", help="Folders that hold results.json files at any depth.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for the site; open its index.html.")] = Path("site"),
    title: Annotated[str, typer.Option(help="Title of the first page.")] = "Conformance results",
) -> CommandOutput:
    """Write a static site from many results.

    Every verdict leads to its certificate, which is made from results.json again. Results that contradict themselves
    are shown with the verdict `error`.

    Example: pantocheck site results earlier-results --out site
    """
    paths = _find_results(folders, out)
    check_writable(out)
    contents = []
    for path in paths:
        with follow_steps(str(path)):
            results = read_results(path)
            contents.append((results, tuple(find_discrepancies(results))))
    published = order_results(contents)
    ids = sorted({case.id for run in published for case in run.results.cases})
    # A number keeps names apart that differ in signs only.
    pages = {case: f"cases/{number:04d}-{name_file(case)}.html" for number, case in enumerate(ids, 1)}
    for run in published:
        with follow_steps(run.folder):
            write_pages(run.results, out / run.folder, ("html",))
            write_atomically(out / run.folder / FILES["json"], run.results.to_json())
    for case, page in pages.items():
        write_report(build_case_page(case, published), out / page)
    write_report(build_site_index(title, published, pages), out / "index.html")
    refused = {run.folder: list(run.discrepancies) for run in published if run.discrepancies}
    return CommandOutput(
        Text(f"{len(published)} runs, {len(pages)} cases"),
        {"runs": [run.folder for run in published], "cases": list(pages), "discrepancies": refused},
        [indent_text(f"{name}: {found[0]}") for name, found in refused.items()],
        files=(out / "index.html",),
    )


def _find_results(folders: list[Path], out: Path) -> list[Path]:
    """Results below all folders; a file that lies below two of them is taken once."""
    paths: dict[Path, Path] = {}
    for folder in folders:
        own = {path.resolve(): path for path in _walk_results(folder, out)}
        if not own:
            hint = "Write results with pantocheck run --out DIR."
            raise InputError(f"folder '{folder}'", "holds no results.json", hint)
        paths |= {place: path for place, path in own.items() if place not in paths}
    if len(paths) > MOST_RESULTS:
        raise InputError("folders of results", f"more than {MOST_RESULTS} results", "Give folders with fewer results.")
    return list(paths.values())


def _walk_results(folder: Path, out: Path) -> Iterator[Path]:
    """Regular files named results.json below a folder, by name; links and the site itself are left out."""
    if not folder.is_dir():
        raise InputError(f"folder '{folder}'", "is not a folder", "Give the folder that holds the results.")
    site, count = out.resolve(), 0
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if Path(place, name).resolve() != site)
        path = Path(place, FILES["json"])
        if FILES["json"] in names and path.is_file() and not path.is_symlink():
            count += 1
            if count > MOST_RESULTS:
                found = f"more than {MOST_RESULTS} results"
                raise InputError(f"folder '{folder}'", found, "Give a folder with fewer results.")
            yield path
