"""JSON Schemas of every file format, exported from the models that check the files."""

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping_file import DampingFile
from pantocheck.conformance.cases.limits import LimitsFile
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar as MassDropSidecar
from pantocheck.conformance.plan import Plan
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.results_format import results_schema
from pantocheck.conformance.systems.command.protocol_messages import answer_schema, request_schema

_MODELS: dict[str, type[BaseModel]] = {
    "case": CaseFile,
    "line": LineFile,
    "pantograph": PantographFile,
    "damping": DampingFile,
    "limits": LimitsFile,
    "plan": Plan,
    "record": RecordSidecar,
    "mass-drop": MassDropSidecar,
    "summary": RecordSummary,
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
