"""Paragraph with a mark, whose further lines begin below its text."""

from collections.abc import Iterator

from rich.console import Console, ConsoleOptions
from rich.text import Text


class HangingText:
    """Paragraph that wraps below its text, not below its mark.

    Args:
        mark: Begin of the first line, such as two spaces or a bullet.
        text: Text after the mark.
    """

    def __init__(self, mark: str, text: Text) -> None:
        self.mark, self.text = mark, text

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """Lines for the width of the console."""
        width = max(options.max_width - len(self.mark), 1)
        for number, line in enumerate(self.text.wrap(console, width, overflow="fold")):
            yield Text(self.mark if number == 0 else " " * len(self.mark)) + line
