"""Descriptions of keys: the string under a field is its description in the schema and in messages."""

from typing import Annotated

from pydantic import BaseModel, Field, create_model

from pantocheck.conformance.core.validation_messages import (
    DescribedSchema,
    describe_field,
    describe_key,
    read_field_texts,
)

Named = Annotated[str, Field(description="name of any file")]


class Part(BaseModel):
    """Part of a wire."""

    depth_m: Annotated[float, Field(ge=1)]
    """Depth of the part [m];
    measured downwards."""
    colour: str = ""


class Wire(Part):
    """Wire with a part."""

    colour: str = ""
    """RAL number."""
    model: Named
    file: Named
    """Spearman's file."""
    part: Annotated[Part | None, Field(alias="portion")] = None
    """true: a part of it. Null: none."""


def test_string_under_a_field_describes_the_field_and_those_of_derived_tables() -> None:
    own = {"colour": "RAL number.", "file": "Spearman's file.", "part": "true: a part of it. Null: none."}
    assert read_field_texts(Part) == {"depth_m": "Depth of the part [m]; measured downwards."}
    assert read_field_texts(Wire) == {"depth_m": "Depth of the part [m]; measured downwards.", **own}
    # Only `DescribedSchema` and messages read it.
    assert Part.model_fields["depth_m"].description is None
    assert "description" not in Part.model_json_schema()["properties"]["depth_m"]

    class Local(BaseModel):
        count: int
        """Number of parts."""

    assert read_field_texts(Local) == {"count": "Number of parts."}
    assert read_field_texts(create_model("Made", count=int)) == {}


def test_schema_and_sentences_have_the_strings() -> None:
    schema = Wire.model_json_schema(schema_generator=DescribedSchema)
    described = {key: content.get("description") for key, content in schema["properties"].items()}
    assert described == {
        "depth_m": "Depth of the part [m]; measured downwards.", "colour": "RAL number.", "model": "name of any file",
        "file": "Spearman's file.", "portion": "true: a part of it. Null: none.",
    }  # fmt: skip
    nested = schema["$defs"]["Part"]["properties"]
    assert nested["depth_m"]["description"] == "Depth of the part [m]; measured downwards."
    assert "description" not in nested["colour"]
    assert describe_field(Wire, "depth_m") == "depth of the part [m]; measured downwards"
    assert describe_field(Wire, "colour") == "RAL number"
    assert describe_field(Wire, "model") == "name of any file"
    assert describe_field(Wire, "file") == "Spearman's file"
    assert describe_field(Wire, "part") == "true: a part of it. Null: none"
    assert describe_field(Part, "colour") == ""
    assert describe_key(Wire, "depth_m") == (
        "It is: depth of the part [m]; measured downwards. Allowed: a number at least 1."
    )
