"""Blocks of the pages that are not run as a part of their page, each with its reason."""

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from site_pages.page_blocks import Block

DOCS = Path(__file__).parents[1]
LIST = Path(__file__).with_name("unrun_blocks.toml")


@cache
def read_list() -> dict[str, Any]:
    """Content of the list: `block` with page, begin and reason, and `tested_elsewhere` with the test of each page."""
    return tomllib.loads(LIST.read_text(encoding="utf-8"))


def find_reason(block: Block) -> str | None:
    """Reason for which a block is not run; None for a block that is run."""
    page = name_page(block.page)
    if page in read_list()["tested_elsewhere"]:
        return f"{read_list()['tested_elsewhere'][page]} runs it"
    entries = read_list()["block"]
    reasons = [entry["reason"] for entry in entries if entry["page"] == page and block.text.startswith(entry["begins"])]
    return reasons[0] if block.runs and reasons else None


def name_page(page: Path) -> str:
    """Path of a page as in the list: `README.md`, `systems.md`, `tutorials/assessor.md`."""
    return page.relative_to(DOCS if page.is_relative_to(DOCS) else DOCS.parent).as_posix()
