"""Pages of the documentation that messages, helps and drafts name.

A reader of the site or of an installed package has no folder `docs`: a page is named by its title.
"""

from enum import Enum
from importlib.resources import files


class DocumentationPage(Enum):
    """Page of the documentation; its value is the title up to a colon, its text is ready for a sentence."""

    COMPARE_DROP = "A recorded mass drop beside its simulation"
    IDENTIFICATION = "Identification of damping from mass drops"
    LINE_TABLES = "Line tables"
    LOGGER_FILES = "Files of data loggers"
    PANTOGRAPH_RESPONSE = "The measured frequency response of a pantograph"
    RECORDS = "Records"
    SYSTEMS = "Systems under test"
    VALIDATE = "Validation of a simulator for a line"

    def __str__(self) -> str:
        """Name the page as in a sentence."""
        return f"the page '{self.value}' of the documentation"


TEMPLATES = files("pantocheck.templates")
"""Templates and words of the pages, and templates of new input files."""
