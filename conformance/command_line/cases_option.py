"""Option `--cases` of every command that takes cases, without the imports of a run."""

from pathlib import Path
from typing import Annotated

import typer

CasesOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--cases",
        metavar="DIR",
        help="Folder with further cases, whose ids begin with own/; repeat the option for several.",
    ),
]
