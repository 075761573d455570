"""Reference of the commands, from their options and help texts."""

from typing import Any

from pantocheck.conformance.app.commands.command_list import COMMANDS, load_command
from site_pages.markdown_table import build_markdown_table, escape_text


def build_command_page() -> str:
    """Page with every command: purpose, arguments and options."""
    parts = ["# Commands", "`pantocheck COMMAND --help` shows the same text."]
    parts.append(
        build_markdown_table(
            ("command", "purpose"),
            (
                (f"[`{name}`](#pantocheck-{name.replace(' ', '-')})", escape_text(text))
                for name, text in COMMANDS.items()
            ),
        )
    )
    parts += [_build_section(name) for name in COMMANDS]
    return "\n\n".join(parts) + "\n"


def _name_anchor(name: str) -> str:
    return f"#pantocheck-{name.replace(' ', '-')}"


def _build_section(name: str) -> str:
    command = load_command(name)
    parameters = [parameter for parameter in command.params if parameter.name != "help"]
    parts = [f"## pantocheck {name}", *_split_help(command.help or "")]
    rows = [(f"`{_name_parameter(item)}`", escape_text(_describe_parameter(item))) for item in parameters]
    if rows:
        parts.append(build_markdown_table(("argument or option", "meaning"), rows))
    return "\n\n".join(parts)


def _split_help(text: str) -> list[str]:
    """Paragraphs of a help text; example commands become blocks of code."""
    parts = []
    for paragraph in map(str.strip, text.split("\n\n")):
        example = paragraph.removeprefix("Example: ")
        if example.startswith("pantocheck "):
            parts.append(f"```sh\n{example}\n```")
        elif paragraph:
            parts.append(escape_text(" ".join(paragraph.split())))
    return parts


def _name_parameter(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return str(parameter.metavar or parameter.name.upper())
    return ", ".join(parameter.opts)


def _describe_parameter(parameter: Any) -> str:
    default = getattr(parameter, "show_default", None)
    shown = default if isinstance(default, str) else None
    return f"{parameter.help or ''}{f' Default: {shown}.' if shown else ''}"
