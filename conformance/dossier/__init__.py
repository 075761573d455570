"""Dossier and steps of the EN 50318 procedure."""
