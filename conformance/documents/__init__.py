"""Verification and signatures of documents."""
