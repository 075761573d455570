"""From modes.json and a line to damping.json and the TOML block of a case file."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.damping.damping_model import (
    DampingFit,
    MeasuredMode,
    ModalEnergies,
    add_modal_damping,
    fit_damping_model,
    fit_modal_bands,
)
from pantocheck.conformance.identification.damping.mode_pairing import ModePair, pair_modes
from pantocheck.conformance.identification.damping.observability import (
    PLAUSIBLE,
    RATIO_NEEDED,
    SHARE_NEEDED,
    compute_observability,
)
from pantocheck.conformance.identification.identification_files import ModeRow, round_significant
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.model import Catenary, DiscretisedLine, Kind, discretise
from pantocheck.model.modal.modal_damping import modes_below
from pantocheck.model.modal.modes import Modes, component_energies, damping_ratios, deflection_at

KIND_OF_WIRE = {"CW": Kind.CONTACT_WIRE, "MW": Kind.MESSENGER_WIRE, "SW": Kind.STITCH_WIRE}
TABLE = {"dropper": "droppers", "steady_arm": "steady_arms", "messenger_support": "messenger_supports"}
KEY = {"mass": "mass_coefficient_1_s", "stiffness": "stiffness_coefficient_s"}


def build_damping_results(rows: tuple[ModeRow, ...], line: Catenary, element: float, source: str) -> dict[str, Any]:
    """Fit a damping model to identified modes; everything that damping.json holds.

    Parameters
    ----------
    rows : tuple[ModeRow, ...]
        Of modes.json; lateral, uncertain and ungrouped ones are left aside.
    line : Catenary
        The line that was measured; the damping it has already is the reference of the comparison.
    element : float
        Element length [m].
    source : str
        Of the modes, for messages.

    Raises
    ------
    InputError
        Too few modes, or none that the line can account for.
    """
    usable = [row for row in rows if row.certain and not row.lateral and row.group is not None]
    if not usable:
        raise InputError(source, "holds no certain mode that belongs to a group", "Identify longer or more records.")
    placed = _places_of_sensors(usable, line, source)
    mesh = discretise(line, element, tuple(sorted(x for _, x in placed)))
    shapes = modes_below(mesh, 1.1 * max(row.frequency_Hz for row in usable))
    energies = component_energies(mesh, shapes)
    measured_shapes, computed_shapes = _shapes_at_sensors(usable, mesh, shapes, placed)
    pairs = pair_modes(
        np.array([row.frequency_Hz for row in usable]), measured_shapes, shapes.frequency, computed_shapes
    )
    computed = np.array([p.computed for p in pairs], dtype=np.int64)
    paired = [usable[p.measured] for p in pairs]
    if len(paired) < 6:
        raise InputError(
            source,
            f"only {len(paired)} of {len(usable)} modes have a counterpart in the line's model",
            "Name the case of the line measured; its tensions and spans decide the frequencies.",
        )
    kinds = tuple(str(kind) for kind in energies.kinds)
    measured = _measured(paired)
    everything = ModalEnergies(shapes.frequency, kinds, energies.stiffness, energies.mass)
    own = ModalEnergies(shapes.frequency[computed], kinds, energies.stiffness[computed], energies.mass[computed])
    fit = fit_damping_model(own, measured)
    bands = fit_modal_bands(measured)
    rayleigh = _rayleigh(everything, fit)
    return {
        "modes_file": source,
        "residual": round_significant(fit.residual),
        "coefficients": [
            {
                "kind": c.kind,
                "matrix": c.matrix,
                "value": round_significant(c.value),
                "low_95": round_significant(c.low),
                "high_95": round_significant(c.high),
            }
            for c in fit.coefficients
        ],
        "modal": [
            {
                "from_Hz": round_significant(b.low),
                "to_Hz": round_significant(b.high),
                "damping_ratio": round_significant(b.damping_ratio),
            }
            for b in bands
        ],
        "observability": _observability(own, measured, fit),
        "thresholds": {"largest_share": SHARE_NEEDED, "plausible_over_std": RATIO_NEEDED},
        "pairs": [
            _pair_row(p, row, fit, i, shapes.frequency) for i, (p, row) in enumerate(zip(pairs, paired, strict=True))
        ],
        "comparison": {
            "measured": {
                "frequency_Hz": [row.frequency_Hz for row in paired],
                "damping_ratio": [row.damping_ratio for row in paired],
                "std": [row.damping_ratio_std for row in paired],
            },
            "frequency_Hz": [round_significant(f) for f in shapes.frequency],
            "models": {
                "line as it is": [round_significant(z) for z in damping_ratios(mesh, shapes)],
                "Rayleigh": [round_significant(z) for z in rayleigh],
                "Rayleigh + modal": [
                    round_significant(z) for z in add_modal_damping(shapes.frequency, rayleigh, bands)
                ],
            },
        },
        "unpaired": [row.frequency_Hz for i, row in enumerate(usable) if i not in {p.measured for p in pairs}],
    }


def _places_of_sensors(usable: list[ModeRow], line: Catenary, source: str) -> set[tuple[str, float]]:
    """Wire and place of every sensor that has a counterpart on the line; one off the line is an error."""
    sensors = {(shape.wire, shape.position_m) for row in usable for shape in row.sensor_shape}
    placed = {(wire, x) for wire, x in sensors if x is not None and wire in KIND_OF_WIRE}
    end = max(wire.end for wire in line.wires)
    outside = sorted(x for _, x in placed if not 0 <= x <= end)
    if outside:
        raise InputError(
            source, f"a sensor at {outside[0]:g} m, the line ends at {end:g} m", "Name the case of the line measured."
        )
    return placed


def _shapes_at_sensors(
    usable: list[ModeRow], mesh: DiscretisedLine, shapes: Modes, placed: set[tuple[str, float]]
) -> tuple[list[ComplexArray], list[RealArray]]:
    """Measured and computed mode shapes at the sensors of each identified mode."""
    rows_of = {name: mesh.mesh.row_of[_wire(mesh.catenary, KIND_OF_WIRE[name]), "z"] for name, _ in placed}
    at = {(wire, x): deflection_at(mesh, shapes, rows_of[wire], x) for wire, x in placed}
    measured, computed = [], []
    for row in usable:
        known = [s for s in row.sensor_shape if (s.wire, s.position_m) in at]
        measured.append(np.array([complex(s.re, s.im) for s in known]))
        columns = [at[s.wire, s.position_m] for s in known if s.position_m is not None]
        computed.append(np.array(columns).T if columns else np.zeros((shapes.frequency.size, 0)))
    return measured, computed


def _measured(paired: list[ModeRow]) -> MeasuredMode:
    return MeasuredMode(
        np.array([row.frequency_Hz for row in paired]),
        np.array([row.damping_ratio for row in paired]),
        np.array([row.damping_ratio_std for row in paired]),
        np.array([row.group or 0 for row in paired], dtype=np.int64),
    )


def write_damping_toml(results: dict[str, Any], modal: Sequence[dict[str, float]] = ()) -> str:
    """The table `damping` that a line file takes as it is.

    Parameters
    ----------
    results : dict[str, Any]
        Of `damping_results`.
    modal : Sequence[dict[str, float]]
        Bands with a ratio of their own, `results["modal"]` for Rayleigh + modal damping.
    """
    tables: dict[str, Any] = {
        "trust": "provisional",
        "source": f"fitted to {results['modes_file']} by pantocheck fit-damping"[:500],
        "note": f"residual {100 * results['residual']:.2g} % of the measured damping ratios",
    }
    for one in results["coefficients"]:
        tables.setdefault(TABLE.get(one["kind"], one["kind"]), {})[KEY[one["matrix"]]] = one["value"]
    if modal:
        tables["modal"] = list(modal)
    return tomli_w.dumps({"damping": tables}, multiline_strings=False)


def _wire(line: Catenary, kind: Kind) -> str:
    for wire in line.wires:
        if wire.kind is kind:
            return wire.name
    raise InputError("line", f"has no {kind.replace('_', ' ')}", "Name the case of the line measured.")


def _rayleigh(energies: ModalEnergies, fit: DampingFit) -> RealArray:
    names, columns = energies.columns()
    return np.asarray(columns @ np.array([fit.value(*name) for name in names]))


def _observability(energies: ModalEnergies, measured: MeasuredMode, fit: DampingFit) -> list[dict[str, Any]]:
    return [
        {
            "kind": one.kind,
            "matrix": one.matrix,
            "largest_share": round_significant(one.share),
            "variance_inflation": round_significant(one.inflation) if np.isfinite(one.inflation) else None,
            "std": round_significant(one.std) if np.isfinite(one.std) else None,
            "plausible": PLAUSIBLE[one.matrix],
            "plausible_over_std": round_significant(PLAUSIBLE[one.matrix] / one.std) if np.isfinite(one.std) else 0.0,
            "residual_without": round_significant(one.growth),
            "observable": one.observable,
        }
        for one in compute_observability(energies, measured, fit)
        if one.share > 0
    ]


def _pair_row(p: ModePair, row: ModeRow, fit: DampingFit, i: int, frequency: RealArray) -> dict[str, Any]:
    return {
        "measured_Hz": row.frequency_Hz,
        "computed_Hz": round_significant(float(frequency[p.computed])),
        "mac": round_significant(p.mac),
        "group": row.group,
        "measured": row.damping_ratio,
        "fitted": round_significant(float(fit.predicted[i])),
        "used": bool(fit.used[i]),
    }
