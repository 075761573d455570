"""Fixture of the tests of mass-drop records."""

import pytest

from helpers.drop_records import build_drop_record
from pantocheck.conformance.drops.drop_record import DropRecord


@pytest.fixture
def record() -> DropRecord:
    return build_drop_record()
