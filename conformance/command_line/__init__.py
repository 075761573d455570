"""The `pantocheck` command."""
