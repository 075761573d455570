"""Comparisons with packages of others, one file per package; each runs only where its package is installed."""
