"""Sliders of a case: the inputs that a reader changes, with their ranges, and the changes that follow from them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.results.exploration_format import Slider

COEFFICIENTS = ("mass_coefficient_1_s", "stiffness_coefficient_s")
"""Keys of the damping of a kind of component."""


@dataclass(frozen=True)
class SliderKind:
    """Input that has a slider where a case states it, with a range relative to its value."""

    label: str
    unit: str
    key: str
    """Key in its file."""
    lowest: float
    highest: float
    """Ends of the range over the value of the case."""
    step: float
    is_logarithmic: bool = False

    def build(self, label: str, keys: Mapping[str, float], value: float, is_factor: bool = False) -> Slider:
        """Slider of keys that have a common value; its id is the first of them."""
        low, high = (self._round(value * share) for share in (self.lowest, self.highest))
        return Slider(
            id=next(iter(keys)),
            label=label,
            unit=self.unit,
            value=value,
            low=min(low, value),
            high=max(high, value),
            step=self.step,
            keys=dict(keys),
            is_factor=is_factor,
            is_logarithmic=self.is_logarithmic,
        )

    def _round(self, value: float) -> float:
        """Value with a multiple of the step, or of a logarithmic slider with three digits."""
        return float(f"{value:.3g}") if self.is_logarithmic else round(value / self.step) * self.step


SPEED_SLIDER = SliderKind("speed", "km/h", "speed_km_h", 0.5, 1.5, 1.0)
SPACING_SLIDER = SliderKind("pantograph spacing", "m", "spacing_m", 0.4, 1.6, 0.5)
LINE_SLIDERS = (
    SliderKind("contact wire tension", "N", "contact_wire.tension_N", 0.6, 1.5, 100.0),
    SliderKind("messenger wire tension", "N", "messenger_wire.tension_N", 0.6, 1.5, 100.0),
    SliderKind("dropper stiffness", "N/m", "droppers.stiffness_N_m", 0.1, 10.0, 1.0, is_logarithmic=True),
    SliderKind("dropper axial stiffness EA", "N", "droppers.axial_stiffness_EA_N", 0.1, 10.0, 1.0, is_logarithmic=True),
)
DAMPING_SLIDER = SliderKind("damping of the line", "times", "damping", 0.0, 4.0, 0.05)
FORCE_SLIDERS = (
    SliderKind("uplift force", "N", "uplift_force_N", 0.6, 1.5, 1.0),
    SliderKind("mean contact force", "N", "target_mean_force_N", 0.6, 1.5, 1.0),
)
CONTACT_SLIDER = SliderKind("contact stiffness", "N/m", "contact.stiffness_N_m", 0.1, 10.0, 1.0, is_logarithmic=True)


def list_sliders(case: Case) -> list[Slider]:
    """Sliders of a case with a train: those of the inputs that its files state as numbers."""
    speed = case.file.speed_km_h or 0.0
    sliders = [SPEED_SLIDER.build(SPEED_SLIDER.label, {SPEED_SLIDER.key: speed}, speed)]
    for kind in LINE_SLIDERS:
        if (value := _read_number(case.line, kind.key)) is not None:
            sliders.append(kind.build(kind.label, {f"line.{kind.key}": value}, value))
    # A damping of the case replaces that of its line, whose keys have no effect then.
    if case.file.damping is None and (damping := dict(_list_damping(case))):
        sliders.append(DAMPING_SLIDER.build(DAMPING_SLIDER.label, damping, 1.0, is_factor=True))
    tuned = any(_read_number(use, FORCE_SLIDERS[1].key) for use in case.file.pantograph)
    sliders += _list_by_pantograph(FORCE_SLIDERS[tuned], case.file.pantograph)
    sliders += _list_by_pantograph(CONTACT_SLIDER, case.pantographs)
    spacing = case.file.spacing_m or ()
    for number, value in enumerate(spacing, 1):
        key = SPACING_SLIDER.key if len(spacing) == 1 else f"{SPACING_SLIDER.key}[{number}]"
        label = SPACING_SLIDER.label if len(spacing) == 1 else f"{SPACING_SLIDER.label} {number}"
        sliders.append(SPACING_SLIDER.build(label, {key: value}, value))
    return sliders


def _read_number(table: object, key: str) -> float | None:
    """Number under a dotted key of a table; None: there is none."""
    for part in key.split("."):
        table = getattr(table, part, None)
    return table if isinstance(table, float) and table > 0 else None


def _list_damping(case: Case) -> Iterator[tuple[str, float]]:
    """Coefficients and ratios of the damping of the line that are not 0."""
    damping = case.line.damping
    for component in type(damping).model_fields:
        for name in COEFFICIENTS:
            if (value := _read_number(damping, f"{component}.{name}")) is not None:
                yield f"line.damping.{component}.{name}", value
    for number, band in enumerate(damping.modal, 1):
        if band.damping_ratio:
            yield f"line.damping.modal[{number}].damping_ratio", band.damping_ratio


def _list_by_pantograph(kind: SliderKind, tables: Sequence[object]) -> list[Slider]:
    """One slider if all pantographs share a value, else one for each that states it."""
    values = [_read_number(table, kind.key) for table in tables]
    if len(set(values)) == 1 and values[0] is not None:
        return [kind.build(kind.label, {f"pantograph.{kind.key}": values[0]}, values[0])]
    return [
        kind.build(f"{kind.label}, pantograph {number}", {f"pantograph[{number}].{kind.key}": value}, value)
        for number, value in enumerate(values, 1)
        if value is not None
    ]


def find_slider(sliders: Sequence[Slider], name: str) -> Slider:
    """Slider of an id.

    Raises:
        InputError: There is none.
    """
    if (found := next((slider for slider in sliders if slider.id == name), None)) is None:
        names = suggest_names(name[:80], [slider.id for slider in sliders])
        raise InputError(f"slider {name[:80]!r}", "is not on this page", names)
    return found


def set_slider(slider: Slider, value: float) -> dict[str, float]:
    """New values by key; none at the value of the case.

    Raises:
        InputError: The value is outside of the range of the slider.
    """
    if not (math.isfinite(value) and slider.low <= value <= slider.high):
        hint = f"Choose {slider.low:g} to {slider.high:g} {slider.unit}."
        raise InputError(slider.label, f"{value:g} {slider.unit} is outside of its range", hint)
    if value == slider.value:
        return {}
    return {key: base * value if slider.is_factor else value for key, base in slider.keys.items()}


def build_changes(sliders: Sequence[Slider], values: Mapping[str, float]) -> tuple[InputChange, ...]:
    """Changes of the inputs at a setting of the sliders; a slider without a value stands at that of the case.

    Raises:
        InputError: A slider does not exist, or a value is outside of its range.
    """
    settings = {name: set_slider(find_slider(sliders, name), value) for name, value in values.items()}
    ordered = (settings.get(slider.id, {}) for slider in sliders)
    return tuple(build_change(key, value) for setting in ordered for key, value in setting.items())
