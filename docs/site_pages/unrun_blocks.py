"""Blocks of the pages that neither the tests nor the site run, each with its reason."""

import tomllib
from pathlib import Path

from site_pages.page_blocks import Block

LIST = Path(__file__).with_name("unrun_blocks.toml")


def read_unrun_blocks() -> dict[tuple[str, str], str]:
    """Reason for each block that is not run, by its page and its first line."""
    entries = tomllib.loads(LIST.read_text(encoding="utf-8"))["block"]
    return {(entry["page"], entry["begins"]): entry["reason"] for entry in entries}


def is_run_by_hand(block: Block) -> bool:
    """Whether a block is in the list of blocks that are not run."""
    return block.runs and (name_page(block), block.first_line) in read_unrun_blocks()


def name_page(block: Block) -> str:
    """Path of the page of a block as in the list: `README.md`, `systems.md`, `tutorials/assessor.md`."""
    docs = Path(__file__).parents[1]
    return block.page.relative_to(docs if block.page.is_relative_to(docs) else docs.parent).as_posix()
