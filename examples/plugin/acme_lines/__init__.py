"""Example of an extension of Pantocheck."""
