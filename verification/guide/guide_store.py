"""Finished parts of a guide as files, so that an interrupted guide continues."""

import json
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.results_part import ResultsPart
from verification.guide.guide_tasks import GuideTask

FOLDER_OF_PARTS = "parts"
"""Folder of the finished parts in that of the guide."""


@dataclass(frozen=True)
class GuideStore:
    """Folder of finished parts."""

    folder: Path
    """Folder of the guide."""
    identity: str
    """Suite and platform of the guide; parts of another one are computed again."""

    def read(self, task: GuideTask) -> ResultsPart | None:
        """Content of a finished part of this suite and platform; None if there is none."""
        try:
            stored = json.loads(self._path(task).read_text("utf-8"))
            if stored["identity"] != self._identify(task):
                return None
            return task.content.model_validate(stored["content"])
        except (OSError, ValueError, KeyError, TypeError, ValidationError):
            return None  # absent, damaged or of another format: the part is computed again

    def write(self, task: GuideTask, content: ResultsPart) -> None:
        """Store a finished part.

        Raises:
            InputError: The file cannot be written.
        """
        stored = {"identity": self._identify(task), "content": content.model_dump(mode="json", by_alias=True)}
        write_atomically(self._path(task), json.dumps(stored, allow_nan=False).encode("ascii"))

    def _identify(self, task: GuideTask) -> str:
        return f"{self.identity} {task.subject}"

    def _path(self, task: GuideTask) -> Path:
        return self.folder / FOLDER_OF_PARTS / f"{task.name.replace('/', '--')}.json"
