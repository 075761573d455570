"""Origin of a case from outside the library: a file, a folder of the user, or an installed distribution."""

from dataclasses import dataclass
from typing import Literal

OriginKind = Literal["file", "folder", "distribution"]


@dataclass(frozen=True)
class CaseOrigin:
    """Place from which a case was read.

    Parameters
    ----------
    kind : {"file", "folder", "distribution"}
        Case file named by its path, folder given with `--cases`, or installed distribution.
    name : str
        Name of the file, of the folder or of the distribution, without the path on this machine.
    version : str
        Version of a distribution; empty for a file or folder.
    digest : str
        SHA-256 of the case file, or of all TOML files of the folder or distribution with their names.
    """

    kind: OriginKind
    name: str
    version: str
    digest: str

    @property
    def text(self) -> str:
        """Origin in messages, such as `distribution acme-lines 1.0`."""
        return f"{self.kind} {self.name} {self.version}".strip()
