"""Procedure of EN 50318 for a dossier: one file per step."""
