"""JSON Schemas of all file formats, generated from the models that check or write the files.

Each schema is self-contained, because TOML editors (Taplo) do not follow references to another local file.
"""

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any, cast

from pydantic import BaseModel
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pantocheck.conformance.core.validation_messages import DescribedSchema


class Formats(Mapping[str, type[BaseModel]]):
    """Models of file formats by name; the file of a model is imported when the model is needed."""

    def __init__(self, places: Mapping[str, str]) -> None:
        self.places = places
        """File and class of each model."""

    def __getitem__(self, name: str) -> type[BaseModel]:
        file, _, model = self.places[name].rpartition(".")
        return cast(type[BaseModel], getattr(import_module(f"pantocheck.conformance.{file}"), model))

    def __iter__(self) -> Iterator[str]:
        return iter(self.places)

    def __len__(self) -> int:
        return len(self.places)


READ_FORMATS = Formats(
    {
        "case": "cases.case_file.CaseFile",
        "line": "line.line_file.LineFile",
        "pantograph": "pantograph.pantograph_file.PantographFile",
        "damping": "line.elements.damping.DampingFile",
        "limits": "cases.limits.LimitsFile",
        "plan": "execution.plan.Plan",
        "campaign": "campaigns.campaign_file.CampaignFile",
        "dossier": "dossier.dossier_file.DossierFile",
        "record": "records.record_sidecar.RecordSidecar",
        "mass-drop": "drops.drop_sidecar.DropSidecar",
        "static": "comparison.static_record.StaticSidecar",
        "response": "pantograph.response_record.ResponseSidecar",
        "comparison-limits": "comparison.comparison_limits.ComparisonLimits",
        "summary": "records.record_summary.RecordSummary",
        "profile": "cases.profile_file.Profile",
        "administration": "results.administration.Administration",
        "converged": "cases.converged_file.ConvergedFile",
        "model-uncertainty": "runs.resolution.ModelUncertaintyFile",
        "resolving-power": "cases.input_studies.ResolvingPowerFile",
        "conditions": "cases.input_studies.ConditionsFile",
    }
)
"""TOML files that users write, and those of computed values; `reference_cases/schema` has their schemas."""

WRITTEN_FORMATS = Formats(
    {
        "results": "results.results_format.Results",
        "modes": "results.identified_modes.ModesFile",
        "identification": "results.identification_format.IdentificationFile",
        "population": "results.population_format.PopulationFile",
        "damping-fit": "results.damping_format.DampingResults",
        "comparison": "results.comparison_format.RunComparison",
        "static-comparison": "results.comparison_format.StaticComparison",
        "campaign-results": "results.campaign_format.CampaignResults",
        "drop-comparison": "results.drop_comparison_format.DropComparison",
        "response-comparison": "results.comparison_format.ResponseComparison",
        "pantograph-fit": "results.pantograph_fit_format.PantographFit",
    }
)
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
        from pantocheck.conformance.runs.protocol_messages import answer_schema, request_schema

        schema = (request_schema if name == "command-request" else answer_schema)(WrittenSchema)
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
