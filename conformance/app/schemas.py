"""JSON Schemas of all file formats, generated from the models that check or write the files.

Each schema is self-contained, because TOML editors (Taplo) do not follow references to another local file.
"""

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.converged_file import ConvergedFile
from pantocheck.conformance.cases.input_studies import ConditionsFile, ResolvingPowerFile
from pantocheck.conformance.cases.limits import LimitsFile
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimits
from pantocheck.conformance.comparison.static_record import StaticSidecar
from pantocheck.conformance.core.validation_messages import DescribedSchema
from pantocheck.conformance.dossier.dossier_file import DossierFile
from pantocheck.conformance.drops.drop_sidecar import DropSidecar as MassDropSidecar
from pantocheck.conformance.execution.plan import Plan
from pantocheck.conformance.line.elements.damping import DampingFile
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import ResponseSidecar
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.results.campaign_format import CampaignResults
from pantocheck.conformance.results.comparison_format import ResponseComparison, RunComparison, StaticComparison
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.drop_comparison_format import DropComparison
from pantocheck.conformance.results.identification_format import IdentificationFile
from pantocheck.conformance.results.identified_modes import ModesFile
from pantocheck.conformance.results.pantograph_fit_format import PantographFit
from pantocheck.conformance.results.population_format import PopulationFile
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.protocol_messages import answer_schema, request_schema
from pantocheck.conformance.runs.resolution import ModelUncertaintyFile

USER_FORMATS: dict[str, type[BaseModel]] = {
    "case": CaseFile,
    "line": LineFile,
    "pantograph": PantographFile,
    "damping": DampingFile,
    "limits": LimitsFile,
    "plan": Plan,
    "campaign": CampaignFile,
    "dossier": DossierFile,
    "record": RecordSidecar,
    "mass-drop": MassDropSidecar,
    "static": StaticSidecar,
    "response": ResponseSidecar,
    "comparison-limits": ComparisonLimits,
    "summary": RecordSummary,
    "profile": Profile,
    "administration": Administration,
}
"""TOML files that users write; `reference_cases/schema` has their schemas, for editors."""

READ_FORMATS: dict[str, type[BaseModel]] = {
    **USER_FORMATS,
    "converged": ConvergedFile,
    "model-uncertainty": ModelUncertaintyFile,
    "resolving-power": ResolvingPowerFile,
    "conditions": ConditionsFile,
}
"""TOML files that users write, and those of computed values of the library."""

WRITTEN_FORMATS: dict[str, type[BaseModel]] = {
    "results": Results,
    "modes": ModesFile,
    "identification": IdentificationFile,
    "population": PopulationFile,
    "damping-fit": DampingResults,
    "comparison": RunComparison,
    "static-comparison": StaticComparison,
    "campaign-results": CampaignResults,
    "drop-comparison": DropComparison,
    "response-comparison": ResponseComparison,
    "pantograph-fit": PantographFit,
}
"""JSON files that the suite writes."""

FORMAT_NAMES = (*READ_FORMATS, *WRITTEN_FORMATS, "command-request", "command-answer")

DRAFT = "https://json-schema.org/draft/2020-12/schema"
LINE_WIDTH = 120


class WrittenSchema(DescribedSchema):
    """Schema of JSON: keys have no title, so that an editor shows their description."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Omit the title that pydantic derives from the name of a key."""
        return False


class ReadSchema(WrittenSchema):
    """Schema of TOML, which has no null: a key that may be None is left out of the file."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        """Schema of the value where there is one."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        """Schema with its default, unless that is None."""
        described = super().default_schema(schema)
        return {key: value for key, value in described.items() if (key, value) != ("default", None)}


def build_schema(name: str) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of one of `FORMAT_NAMES`; it refers to nothing outside itself."""
    if name in READ_FORMATS:
        schema = READ_FORMATS[name].model_json_schema(schema_generator=ReadSchema)
    elif name in WRITTEN_FORMATS:
        schema = WRITTEN_FORMATS[name].model_json_schema(schema_generator=WrittenSchema, mode="serialization")
    else:
        messages = {"command-request": request_schema, "command-answer": answer_schema}
        schema = messages[name](WrittenSchema)
    return {"$schema": DRAFT, **_share_properties(schema)}


def format_schema(schema: dict[str, Any]) -> str:
    """Text of a schema: a value that fits into one line takes one line."""
    return _format_value(schema, "") + "\n"


def _share_properties(schema: dict[str, Any]) -> dict[str, Any]:
    """Move a key that occurs in several tables with the same schema, such as `source`, to the definitions."""
    counts = Counter((key, json.dumps(value)) for table in _tables(schema) for key, value in table.items())
    shared: dict[str, str] = {}
    for (key, text), count in counts.most_common():
        if count > 1 and len(text) > LINE_WIDTH:
            shared.setdefault(key, text)
    for table in _tables(schema):
        for key, value in table.items():
            if shared.get(key) == json.dumps(value):
                table[key] = {"$ref": f"#/$defs/{key}"}
    definitions = {key: json.loads(text) for key, text in shared.items()}
    return {**schema, "$defs": {**definitions, **schema["$defs"]}} if shared else schema


def _tables(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Keys of every table that a schema defines."""
    for table in (schema, *schema.get("$defs", {}).values()):
        yield table.get("properties", {})


def _format_value(value: Any, indent: str, prefix: str = "") -> str:
    """Value after a prefix (its key), the rows of a longer one indented."""
    line = prefix + json.dumps(value)
    if not value or not isinstance(value, dict | list) or len(indent) + len(line) < LINE_WIDTH:
        return indent + line
    if isinstance(value, list):
        opening, closing, rows = "[", "]", [_format_value(item, indent + " ") for item in value]
    else:
        opening, closing = "{", "}"
        rows = [_format_value(item, indent + " ", f"{json.dumps(key)}: ") for key, item in value.items()]
    return f"{indent}{prefix}{opening}\n" + ",\n".join(rows) + f"\n{indent}{closing}"
