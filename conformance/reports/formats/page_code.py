"""Styles and scripts of a page, and the security policy that admits them by their digests and nothing else."""

from base64 import b64encode
from dataclasses import dataclass
from functools import cache
from hashlib import sha256

from pantocheck.conformance.reports.words import TEMPLATES

PAGE_STYLE = "page.css"
TABLE_SCRIPTS = ("scripts/folding.js", "scripts/tables.js")
"""Parts of the script of every page."""


@dataclass(frozen=True)
class PageCode:
    """Style sheets and scripts of a page."""

    styles: tuple[str, ...]
    scripts: tuple[str, ...]

    @property
    def policy(self) -> str:
        """Content security policy: no request, no code but these texts; `data:` admits images inside figures."""
        sources = {"script-src": self.scripts, "style-src": self.styles}
        admitted = (f"{name} {' '.join(map(_digest, texts))}" for name, texts in sources.items())
        return "; ".join(("default-src 'none'", *admitted, "img-src data:", "base-uri 'none'", "form-action 'none'"))


@cache
def read_page_code() -> PageCode:
    """Styles and scripts of every page."""
    return PageCode((_read(PAGE_STYLE),), (_join_parts(TABLE_SCRIPTS),))


def _read(name: str) -> str:
    return (TEMPLATES / name).read_text("utf-8")


def _join_parts(names: tuple[str, ...]) -> str:
    """Parts of a script in one scope, so that their names do not reach the page."""
    return "\n".join(("(() => {", '"use strict";', *map(_read, names), "})();"))


def _digest(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
