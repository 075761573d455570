"""Columns of a campaign with known numbers."""

from typing import Any

import numpy as np

from pantocheck.conformance.campaigns.campaign_columns import CampaignColumns


def build_columns(inputs: dict[str, tuple[Any, ...]], values: dict[str, np.ndarray]) -> CampaignColumns:
    """Runs of one case on one system, by their inputs and values."""
    runs = len(next(iter(values.values())))
    return CampaignColumns(("a",) * runs, ("builtin",) * runs, inputs, values, np.arange(1, runs + 1))
