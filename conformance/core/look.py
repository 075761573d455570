"""Look of pages and figures: colours, sizes of letters and symbols, which `templates/look.toml` states once."""

import json
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from typing import Any

from pantocheck.conformance.core.texts import TEMPLATES

LOOK_PART = re.compile(r"@look\.([a-z-]+)@")
"""Place of a part of the look in a style sheet or script."""


@cache
def read_look() -> Mapping[str, Any]:
    """Parts of the look by their name."""
    return tomllib.loads((TEMPLATES / "look.toml").read_text("utf-8"))


def insert_look(text: str) -> str:
    """Text of a style sheet or script with the parts of the look at their marks."""
    return LOOK_PART.sub(lambda found: _write_part(found[1]), text)


def _write_part(name: str) -> str:
    """Colours or sizes as custom properties of a style sheet; another part as a value of a script."""
    part = read_look()[name]
    if name not in PROPERTIES:
        return json.dumps(part, separators=(",", ":"))
    prefix, unit = PROPERTIES[name]
    return " ".join(f"--{prefix}{key}: {value}{unit};" for key, value in part.items())


PROPERTIES = {
    **dict.fromkeys(("light", "dark", "light-verdict", "dark-verdict"), ("", "")),
    "screen-size": ("size-", "rem"),
    "paper-size": ("paper-", "pt"),
}
"""Parts of a style sheet: beginning of the names of their properties, and unit of the values."""
