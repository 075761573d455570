"""Texts for a reader: numbers with nouns, names of documentation pages, characters that no page may show."""

import re
import unicodedata
from enum import Enum
from importlib.resources import files


def count_noun(number: int, noun: str, plural: str | None = None) -> str:
    """Write a number of things: `1 pantograph`, `2 pantographs`.

    Args:
        number: Number of things.
        noun: Noun for one thing.
        plural: Noun for several things; by default the noun with an s.

    Returns:
        The number and the noun that belongs to it.
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


# Pages of the documentation that messages, helps and drafts name.
#
# A reader of the site or of an installed package has no folder `docs`: a page is named by its title.
class DocumentationPage(Enum):
    """Page of the documentation; its value is the title up to a colon, its text is ready for a sentence."""

    COMPARE_DROP = "A recorded mass drop beside its simulation"
    FMU = "Pantographs and lines as FMU"
    IDENTIFICATION = "Identification of damping from mass drops"
    IDENTIFICATION_COVERAGE = "Coverage of the identification"
    LINE_TABLES = "Line tables"
    LOGGER_FILES = "Files of data loggers"
    PANTOGRAPH_RESPONSE = "The measured frequency response of a pantograph"
    READINGS = "Readings of the evaluation"
    RECORDS = "Records"
    SYSTEMS = "Systems under test"
    RIG = "A line against a rig"
    VALIDATE = "Validation of a simulator for a line"

    def __str__(self) -> str:
        """Name the page as in a sentence."""
        return f"the page '{self.value}' of the documentation"


TEMPLATES = files("pantocheck.templates")
"""Templates and words of the pages, and templates of new input files."""


# Characters that no page may show.

# Noncharacters, private use and lone surrogates have no meaning for a reader; bidirectional controls can make one text
# look like another ("gpj.exe" for "exe.jpg").
UNSHOWABLE = re.compile("[\ud800-\udfff\ue000-\uf8ff\ufdd0-\ufdef\ufffe\uffff\U000f0000-\U0010ffff]")
BIDIRECTIONAL = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def is_control(character: str) -> bool:
    """Whether a character is a control character, such as a line break."""
    return unicodedata.category(character) == "Cc"


def find_unshowable(text: str) -> str | None:
    """First control, bidirectional, private or undefined character of a text; None without one."""
    forbidden = (c for c in text if is_control(c) or UNSHOWABLE.match(c) or BIDIRECTIONAL.match(c))
    return next(forbidden, None)
