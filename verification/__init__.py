"""Evidence about the product; not part of the wheel."""
