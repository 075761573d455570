"""Identity of the software that lays out pages and figures, without loading it: Typst and matplotlib load slowly."""

import hashlib
import platform as host
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from pantocheck.conformance.core.extras import version_or_absence
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.results.results_format import Renderer

FONT_FILES = "mpl-data/fonts/ttf/DejaVuSans*.ttf"
"""Fonts of the pages beside those that Typst brings, in the folder of matplotlib."""


@cache
def identify_renderer() -> Renderer:
    """Versions of the installed software that lays out pages."""
    return Renderer(
        typst=version_or_absence("typst"),
        matplotlib=version("matplotlib"),
        jinja2=version("jinja2"),
        numpy=version("numpy"),
        fonts=_fonts_digest(),
        machine=host.machine(),
        system=host.system(),
    )


def _fonts_digest() -> str:
    matplotlib = find_spec("matplotlib")
    folder = Path(str(matplotlib.origin)).parent if matplotlib else Path()
    digest = hashlib.sha256()
    for path in sorted(folder.glob(FONT_FILES)):
        digest.update(f"{path.name} {file_digest(path)}\n".encode())
    return f"sha256:{digest.hexdigest()}"
