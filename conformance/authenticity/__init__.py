"""Verification of documents: attachments and recomputation of verdicts."""
