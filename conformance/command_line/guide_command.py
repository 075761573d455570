"""`pantocheck guide`: verification and validation guide from results of this version."""

import time
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.command_line.console import console, escape_text
from pantocheck.conformance.command_line.file_list import print_files
from pantocheck.conformance.guide.guide_building import build_guide, guide_identity, list_deviations
from pantocheck.conformance.guide.guide_driver import compute_parts
from pantocheck.conformance.guide.guide_store import GuideStore
from pantocheck.conformance.guide.guide_tasks import list_tasks
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.input_files.atomic_writing import check_writable
from pantocheck.conformance.reports.formats.report_writers import write_document
from pantocheck.conformance.reports.guide.guide_page import build_guide_page


def guide_command(
    out: Annotated[Path, typer.Option(help="Folder for guide.html, guide.pdf and guide.json.")],
    jobs: Annotated[int, typer.Option(min=1, max=256, help="Number of parallel processes.")] = 1,
) -> None:
    """Write the verification and validation guide: every number is computed now, by this version.

    Closed forms, second formulations, published cases and their uncertainty. Finished parts are stored; after an
    interruption the same command continues, and another version computes all parts again.

    Example: pantocheck guide --out guide --jobs 2
    """
    check_writable(out)
    store = GuideStore(out, guide_identity())
    guide = build_guide(compute_parts(list_tasks(), store, jobs, _print_progress))
    write_model(out / "guide.json", guide)
    page = build_guide_page(guide.model_dump(mode="json", by_alias=True))
    output = console()
    print_files([*write_document(page, out / "guide"), out / "guide.json"])
    deviations = list_deviations(guide)
    for name in deviations:
        output.print(escape_text(f"outside its tolerance, or not computed: {name}"), soft_wrap=True)
    raise typer.Exit(1 if deviations else 0)


def _print_progress(part: str, finished: int, total: int) -> None:
    """One line per finished part, on standard error."""
    typer.echo(f"{time.strftime('%H:%M:%S')} {finished} of {total} parts{f': {part}' if part else ''}", err=True)
