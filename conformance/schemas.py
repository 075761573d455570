"""JSON Schemas of every file format, exported from the models that check the files."""

from collections.abc import Callable
from typing import Any

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping import DampingFile
from pantocheck.conformance.cases.limits import LimitsFile
from pantocheck.conformance.cases.line import Line
from pantocheck.conformance.cases.pantograph import Pantograph
from pantocheck.conformance.massdrop_records.sidecar import Sidecar as MassDropSidecar
from pantocheck.conformance.plan import Plan
from pantocheck.conformance.profiles import Profile
from pantocheck.conformance.record_files.sidecar import Sidecar
from pantocheck.conformance.record_files.summary import Summary
from pantocheck.conformance.results import results_schema
from pantocheck.conformance.systems.command.messages import answer_schema, request_schema
from pydantic import BaseModel

_MODELS: dict[str, type[BaseModel]] = {
    "case": CaseFile,
    "line": Line,
    "pantograph": Pantograph,
    "damping": DampingFile,
    "limits": LimitsFile,
    "plan": Plan,
    "record": Sidecar,
    "mass-drop": MassDropSidecar,
    "summary": Summary,
    "profile": Profile,
}

_SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    **{name: model.model_json_schema for name, model in _MODELS.items()},
    "results": results_schema,
    "command-request": request_schema,
    "command-answer": answer_schema,
}

NAMES = tuple(_SCHEMAS)


def schema_of(name: str) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a format of `NAMES`."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **_SCHEMAS[name]()}
