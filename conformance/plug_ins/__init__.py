"""Extensions by other installed distributions: cases, readers, quantities and systems, found by entry points."""
