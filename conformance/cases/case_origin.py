"""Origin of a case from outside the library: a file, a folder of the user, or an installed distribution."""

from typing import Literal

from pantocheck.conformance.input_files.sourced_table import InputTable

OriginKind = Literal["file", "folder", "distribution"]
"""Case file named by its path, folder given with `--cases`, or installed distribution."""


class CaseOrigin(InputTable):
    """File, folder or installed distribution that holds the case file, without its path on this machine."""

    kind: OriginKind
    name: str
    version: str
    """Version of the distribution; empty for a file or folder."""
    digest: str
    """SHA-256 of the case file, or of all TOML files of the folder or distribution."""

    @property
    def text(self) -> str:
        """Origin in messages, such as `distribution acme-lines 1.0`."""
        return f"{self.kind} {self.name} {self.version}".strip()
