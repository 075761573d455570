"""The `pantocheck` command."""

from pantocheck.conformance.command_line.app import app


def main() -> None:
    """Entry point of the `pantocheck` command."""
    app(prog_name="pantocheck")
