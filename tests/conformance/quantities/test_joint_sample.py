"""Joint sample: its moments in closed form, and the correlation between quantities."""

import numpy as np
import pytest

from pantocheck.conformance.quantities.uncertainty import DRAWS, SampleParts, draw_sample

DIGEST = "9f" * 32
VALUES = {0: {"uplift": 50.0}, 1: {"a": 10.0, "b": 20.0, "items": (1.0, 2.0)}}


def column(parts: SampleParts, name: str, owner: int = 1) -> np.ndarray:
    return np.array(draw_sample(parts, DIGEST)[owner][name])


def test_members_are_drawn_equally_and_widened_as_a_further_member() -> None:
    """Of two members at 10 and 14, each is drawn half of the time; sqrt(3 / 1) widens them about 12."""
    found = column(SampleParts(VALUES, [{1: {"a": 14.0}}]), "a")
    assert set(found) == {float(f"{12 + sign * 2 * 3**0.5:.6g}") for sign in (-1, 1)}
    assert found.mean() == pytest.approx(12.0, abs=0.4)  # 3.46 / sqrt(1000) is 0.11 N


def test_quantities_share_their_draw() -> None:
    deviation = np.random.default_rng(1).standard_normal(DRAWS)
    parts = SampleParts(VALUES, deviations={1: {"a": deviation, "b": -2 * deviation}})
    a, b = column(parts, "a"), column(parts, "b")
    assert np.corrcoef(a, b)[0, 1] == pytest.approx(-1.0, abs=1e-6)
    assert b.std() == pytest.approx(2 * deviation.std(), rel=1e-4)  # six digits
    small = SampleParts(VALUES, deviations={1: {"a": 0.01 * deviation}})  # such as a coefficient of variation
    assert column(small, "a").std() == pytest.approx(0.01 * deviation.std(), rel=1e-3)
    both = SampleParts(
        VALUES, deviations={1: {"a": 0 * deviation, "b": 0 * deviation}}, mesh_changes={1: {"a": 1.959964}}
    )
    assert column(both, "a").std() == pytest.approx(1.0, rel=0.07)  # 3 standard deviations of that of 1000 draws


def test_bounds_are_never_left_and_a_quantity_without_scatter_has_no_draws() -> None:
    parts = SampleParts(VALUES, bounds={0: {"uplift": 2.0}}, mesh_changes={1: {"a": 3.0}})
    sample = draw_sample(parts, DIGEST)
    assert sample.keys() == {0}  # mesh and time step alone have an exact interval
    assert 1.8 < np.abs(np.array(sample[0]["uplift"]) - 50.0).max() <= 2.0


def test_same_digest_gives_the_same_sample() -> None:
    parts = SampleParts(VALUES, [{1: {"a": 14.0, "b": 22.0}, 0: {"uplift": 51.0}}])
    assert draw_sample(parts, DIGEST) == draw_sample(parts, DIGEST)
    assert draw_sample(parts, DIGEST) != draw_sample(parts, "ab" * 32)
