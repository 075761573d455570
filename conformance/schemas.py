"""JSON Schemas of every file format, exported from the models that check the files."""

from typing import Any

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping import DampingFile
from pantocheck.conformance.cases.limits import LimitsFile
from pantocheck.conformance.cases.line import Line
from pantocheck.conformance.cases.pantograph import Pantograph
from pantocheck.conformance.plan import Plan
from pantocheck.conformance.record_files.sidecar import Sidecar
from pantocheck.conformance.results import results_schema
from pydantic import BaseModel

_MODELS: dict[str, type[BaseModel]] = {
    "case": CaseFile,
    "line": Line,
    "pantograph": Pantograph,
    "damping": DampingFile,
    "limits": LimitsFile,
    "plan": Plan,
    "record": Sidecar,
}

NAMES = (*_MODELS, "results")


def schema_of(name: str) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a format of `NAMES`."""
    schema = results_schema() if name == "results" else _MODELS[name].model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
