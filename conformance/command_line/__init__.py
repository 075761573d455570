"""The `pantocheck` command."""


def main() -> None:
    """Entry point of the `pantocheck` command."""
    from pantocheck.conformance.command_line.app import app

    app(prog_name="pantocheck")
