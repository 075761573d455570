"""Dossier with the files that it names."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pantocheck.conformance.cases.case import Case, content_digest, json_digest
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.input_files.bounded_file import file_digest
from pantocheck.conformance.plan import place_system
from pantocheck.conformance.procedure.dossier_file import DossierFile
from pantocheck.conformance.procedure.run_pair import RecordRun


@dataclass(frozen=True)
class Dossier:
    """Dossier with its files."""

    file: DossierFile
    """Content of the dossier."""
    folder: Path
    """Folder of the dossier, to which its file names are relative."""
    lines: Mapping[str, LineFile]
    """Lines under validation, by name."""
    pantographs: Mapping[str, PantographFile]
    """Pantographs under validation, by name."""
    cases: tuple[Case, ...]
    """Reference models, with the cases that they require."""
    pair_cases: Mapping[str, Case]
    """Cases of the simulated runs that the system makes, by the name of the pair."""

    @property
    def system(self) -> str:
        """System under test as for `--system`, with paths relative to the working folder."""
        return place_system(self.file.system, self.folder)

    @property
    def digest(self) -> str:
        """SHA-256 of the dossier and of the content of all files that it names."""
        cases = [*self.cases, *self.pair_cases.values()]
        return json_digest(
            {
                "dossier": self.file.model_dump(mode="json"),
                "lines": {name: content_digest(line) for name, line in self.lines.items()},
                "pantographs": {name: content_digest(part) for name, part in self.pantographs.items()},
                "cases": [[case.id, case.digest, limits_digest(case.limits)] for case in cases],
                "sidecars": [file_digest(self.locate(name).with_suffix(".toml")) for _, name in self.list_tables()],
            }
        )

    def locate(self, name: str) -> Path:
        """Path of a file that the dossier names."""
        return self.folder / name

    def list_tables(self) -> Iterator[tuple[str, str]]:
        """Key and name of every measured or simulated table that the dossier names."""
        for i, pantograph in enumerate(self.file.pantograph, 1):
            for k, name in enumerate(pantograph.responses, 1):
                yield f"pantograph[{i}].responses[{k}]", name
        for i, line in enumerate(self.file.line, 1):
            if line.statics is not None:
                yield f"line[{i}].statics", line.statics
        for i, pair in enumerate(self.file.pair, 1):
            if isinstance(pair.simulated, RecordRun):
                yield f"pair[{i}].simulated.record", pair.simulated.record
            yield f"pair[{i}].measured.record", pair.measured.record

    def name_line(self, line: LineFile) -> str:
        """Name of a line in the dossier, recognised by its content; its title if the dossier does not name it."""
        return _find_name(line, self.lines) or line.title

    def name_pantograph(self, pantograph: PantographFile) -> str:
        """Name of a pantograph in the dossier, recognised by its content; its title if the dossier does not name it."""
        return _find_name(pantograph, self.pantographs) or pantograph.title


def _find_name(content: LineFile | PantographFile, known: Mapping[str, LineFile | PantographFile]) -> str | None:
    digest = content_digest(content)
    return next((name for name, other in known.items() if content_digest(other) == digest), None)
