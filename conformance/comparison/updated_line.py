"""Line file of an updated line: scaled values, measured heights of the droppers, and their covariance as tolerances."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.comparison.line_update import HOLD_OUT_LEVEL, LineEstimate
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.drops.line_evidence import DETERMINED
from pantocheck.conformance.line.line_export import export_supports
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line
from pantocheck.conformance.line.line_parameters import build_factor_covariance
from pantocheck.conformance.results.damping_format import FittedProperty, JointCovariance
from pantocheck.conformance.results.line_update_format import HeldOutValue, LineUpdate


def build_updated_line(line: LineFile, estimate: LineEstimate, heights: Sequence[RealArray] | None) -> dict[str, Any]:
    """Content of the line file of an estimate.

    Args:
        line: Line as stated.
        estimate: Estimate of its properties.
        heights: Heights of the contact wire at the droppers of every span [m]; None: as stated.
    """
    tree = line.model_dump(mode="json", exclude_none=True) if heights is None else _list_heights(line, heights)
    for parameter, factor in zip(estimate.parameters, estimate.factors, strict=True):
        for table, key in parameter.keys:
            _scale_key(tree, table, key, float(factor))
        for table, key in parameter.inverse:
            _scale_key(tree, table, key, 1 / float(factor))
    names = [parameter.name for parameter in estimate.parameters]
    std = np.sqrt(np.diag(estimate.covariance))
    correlation = estimate.covariance / np.outer(std, std)
    used = ", ".join(data.name for data in estimate.data)
    tree["tolerance"] = {
        **{
            f"{name}_pct": round(float(100 * s / f), 4) for name, s, f in zip(names, std, estimate.factors, strict=True)
        },
        "source": f"pantocheck line update from {used}"[:500],
        "correlation": {"names": names, "rows": [[round(float(value), 6) for value in row] for row in correlation]},
    }
    return tree


def describe_update(
    estimate: LineEstimate,
    line: LineFile,
    heights: Sequence[RealArray] | None,
    held_out: tuple[HeldOutValue, ...],
    probability: float | None,
) -> LineUpdate:
    """Content of the covariance file; arguments as in `build_updated_line`, and the result of `judge_held_out`."""
    tolerances = np.sqrt(np.diag(build_factor_covariance(line, estimate.parameters)))
    std = np.sqrt(np.diag(estimate.covariance))
    properties = tuple(
        FittedProperty(
            name=parameter.name,
            factor=float(factor),
            low_95=float(factor - QUANTILE_95 * deviation),
            high_95=float(factor + QUANTILE_95 * deviation),
            tolerance=float(tolerance),
            determined=bool(deviation < DETERMINED * tolerance),
        )
        for parameter, factor, deviation, tolerance in zip(
            estimate.parameters, estimate.factors, std, tolerances, strict=True
        )
    )
    verdict: Verdict = "info" if probability is None else "pass" if probability >= HOLD_OUT_LEVEL else "fail"
    return LineUpdate(
        line=line.title,
        data=estimate.data,
        moved_droppers=0 if heights is None else sum(values.size for values in heights),
        properties=properties,
        covariance=JointCovariance(
            names=tuple(row.name for row in properties), rows=tuple(map(tuple, estimate.covariance.tolist()))
        ),
        held_out=held_out,
        probability=probability,
        verdict=verdict,
    ).rounded()


def _scale_key(tree: Any, table: str, key: str, factor: float, inside: str = "") -> None:
    """Multiply a key wherever it stands in tables of a name: those of the line, of its sections and of its supports."""
    if isinstance(tree, list):
        for part in tree:
            _scale_key(part, table, key, factor, inside)
    elif isinstance(tree, dict):
        for name, value in tree.items():
            if name == key and inside == table and isinstance(value, float | int):
                tree[name] = float(f"{value * factor:.8g}")
            else:
                _scale_key(value, table, key, factor, inside if inside == table else name)


def _list_heights(line: LineFile, heights: Sequence[RealArray]) -> dict[str, Any]:
    """Content of a line file with listed spans and these heights at its droppers."""
    rows = ["span,x_m,contact_wire_height_m"]
    for number, (schedule, values) in enumerate(zip(line.dropper_schedules, heights, strict=True), 1):
        rows += [f"{number},{x!r},{value:.6f}" for x, value in zip(schedule.x_m, values.tolist(), strict=True)]
    with TemporaryDirectory() as folder:
        base, supports, droppers = (Path(folder) / name for name in ("line.toml", "supports.csv", "droppers.csv"))
        base.write_text(tomli_w.dumps(line.model_dump(mode="json", exclude_none=True)), encoding="utf-8", newline="\n")
        supports.write_text(export_supports(line), encoding="utf-8", newline="\n")
        droppers.write_text("\n".join(rows) + "\n", encoding="utf-8", newline="\n")
        return import_line(base, supports, droppers)
