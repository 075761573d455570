"""Revisions of a PDF: the document as it was written, and the updates that were appended to it.

A signature is appended to a PDF as an update, and so is any later change. The bytes before it stay as they were.
"""

import re

REVISION_END = re.compile(rb"startxref\s+\d+\s+%%EOF(\r\n|\n|\r)?")
"""End of a revision (ISO 32000-1, 7.5.5)."""


def list_revision_ends(content: bytes) -> tuple[int, ...]:
    """Ends of the revisions of a PDF [bytes], the first one being the document as it was written.

    Args:
        content: Content of the file.
    """
    return tuple(match.end() for match in REVISION_END.finditer(content))


def cut_original_revision(content: bytes) -> bytes:
    """First revision of a PDF, without the updates that were appended to it; all bytes if no revision ends."""
    ends = list_revision_ends(content)
    return content[: ends[0]] if ends else content
