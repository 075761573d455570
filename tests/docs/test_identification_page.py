"""Page about mass drops: its sidecar can be read."""

import re
import tomllib
from pathlib import Path

from jsonschema import validate

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.drops.drop_sidecar import read_drop_sidecar

PAGE = Path(__file__).parents[2] / "docs" / "identification.md"


def test_sidecar_of_the_page_is_read_and_follows_its_schema(tmp_path: Path) -> None:
    text = re.search(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
    (tmp_path / "drop.toml").write_text(text, encoding="utf-8")
    sidecar = read_drop_sidecar(tmp_path / "drop.csv")
    assert (sidecar.drop.mass_kg, sidecar.record.trigger_nominal_s) == (40.0, 6.0)
    assert [channel.unit for channel in sidecar.channel] == ["m/s2"]
    validate(tomllib.loads(text), build_schema("mass-drop"))
