"""Terminal output: where it goes and how verdicts look."""

from rich.console import Console
from rich.text import Text

from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.grading.verdicts import Verdict

_STYLES: dict[Verdict, str] = {
    "pass": "bold green",
    "fail": "bold red",
    "error": "bold red",
    "skip": "yellow",
    "info": "cyan",
}


def console() -> Console:
    """Standard output; wide enough for a table of criteria when it is not a terminal."""
    output = Console(highlight=False, soft_wrap=False)
    return output if output.is_terminal else Console(highlight=False, width=140)


def style_verdict(verdict: Verdict) -> Text:
    """A verdict as it is printed."""
    return Text(verdict.upper(), _STYLES[verdict])


def escape_text(text: str) -> Text:
    """Text of a file, with neither markup nor control characters obeyed."""
    return Text(strip_control_characters(text))


def format_number(value: float | None) -> str:
    """A value as it is printed: four significant digits, a dash for none."""
    return "-" if value is None else f"{value:.4g}"
