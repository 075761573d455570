"""Blocks of a page, at all levels of its sections."""

from collections.abc import Iterable
from typing import TypeVar

from pantocheck.conformance.pages import document as doc

B = TypeVar("B", bound=doc.Block)


def find_blocks(blocks: Iterable[doc.Block], kind: type[B]) -> list[B]:
    """Blocks of a kind in the order of the page."""
    found: list[B] = []
    for block in blocks:
        found += [block] if isinstance(block, kind) else []
        found += find_blocks(block.blocks, kind) if isinstance(block, doc.Section) else []
    return found
