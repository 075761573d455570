"""A guide of two cheap topics and a static case."""

from typing import Any

import pytest

from verification.guide.guide_building import build_guide
from verification.guide.guide_driver import GuideParts
from verification.guide.guide_format import Guide
from verification.guide.guide_tasks import TOPICS
from verification.guide.library_values import compute_library_case

STATIC_CASE = "en50318-2018/ac-simple/static"


@pytest.fixture(scope="session")
def guide() -> Guide:
    """Guide of few parts, computed in two seconds."""
    contents: dict[str, Any] = {f"verification/{name}": TOPICS[name]() for name in ("wire-sag", "wire-frequencies")}
    return build_guide(GuideParts({**contents, f"library/{STATIC_CASE}": compute_library_case(STATIC_CASE)}))
