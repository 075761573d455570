"""Agreement of the files of a case: positions lie on the line, rates fit the time step, force laws fit the speed."""

from collections.abc import Iterator

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import resolve_lift_force
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.force_law import LawInvalid


def find_disagreements(case: Case, where: str) -> Iterator[InputError]:
    """Disagreements between a case and its line.

    Args:
        case: Case whose files are valid, each by itself.
        where: Name of the case file in messages.
    """
    where = f"{where}, key "
    yield from _find_invalid_laws(case, where)
    if not case.is_static:
        outside = [*_find_spans_outside(case, where)]
        yield from outside or _find_positions_outside(case, where)
    yield from _find_wrong_drops(case, f"{where}mass_drop.")


def _find_invalid_laws(case: Case, where: str) -> Iterator[InputError]:
    speed = case.file.speed_km_h or 0.0
    for i, (use, pantograph) in enumerate(zip(case.file.pantograph, case.pantographs, strict=True), 1):
        try:
            resolve_lift_force(use, pantograph, speed)
        except LawInvalid as error:
            hint = "Give uplift_force_N or target_mean_force_N in place of force_from, or another force law or speed."
            yield InputError(f"{where}pantograph[{i}].force_from", str(error), hint)


def _find_spans_outside(case: Case, where: str) -> Iterator[InputError]:
    geometry = case.line.geometry
    for key in ("evaluated_spans", "compared_spans"):
        last = (getattr(case.file, key) or (1,))[-1]
        if last > geometry.spans:
            yield InputError(f"{where}{key}", f"span {last} does not exist", f"The line has {geometry.spans} spans.")
    if case.file.evaluated_m is not None and case.file.evaluated_m[1] > geometry.length:
        yield InputError(
            f"{where}evaluated_m",
            f"the analysis section ends at {case.file.evaluated_m[1]:g} m",
            f"The line ends at {geometry.length:g} m.",
        )


def _find_positions_outside(case: Case, where: str) -> Iterator[InputError]:
    if case.start >= case.recorded_section[0]:
        yield InputError(
            f"{where}start_m",
            f"the last pantograph starts at {case.start:g} m, but the analysis section begins at "
            f"{case.recorded_section[0]:g} m",
            "Reduce start_m, or evaluate a later section.",
        )
    front, length = case.end_positions[0], case.line.geometry.length
    if front >= length:
        yield InputError(
            f"{where}run_out_m",
            f"the first pantograph would run to {front:g} m, but the line is {length:g} m long{_default_run_out(case)}",
            _shorter_section(case),
        )


def _default_run_out(case: Case) -> str:
    if case.file.run_out_m is not None:
        return ""
    return f". The file has no run_out_m; its default here is {case.end - case.recorded_section[1]:g} m"


def _shorter_section(case: Case) -> str:
    geometry = case.line.geometry
    room = geometry.length - case.offsets[-1] - (case.file.run_out_m or 0.0)
    last = sum(limit < room for limit in geometry.span_limits[1:])
    keys = "evaluated_m" if case.file.evaluated_m is not None else "evaluated_spans and compared_spans"
    shorter = f"End {keys} with span {last} at the latest" if last else "Reduce spacing_m"
    return f"{'Reduce run_out_m. ' if case.file.run_out_m else ''}{shorter}, or add spans to the line."


def _find_wrong_drops(case: Case, where: str) -> Iterator[InputError]:
    drops = case.file.mass_drop
    if drops is None:
        return
    length = case.line.geometry.length
    positions = {"drop": [drop.x_m for drop in drops.drop], "sensor": [sensor.x_m for sensor in drops.sensor]}
    for name, along in positions.items():
        for i, x in enumerate(along, 1):
            if not 0 < x < length:
                yield InputError(
                    f"{where}{name}[{i}].x_m",
                    f"{x:g} m is not on the line",
                    f"Give a position between 0 and {length:g} m, the ends of the line.",
                )
    step, every = case.file.discretisation.time_step_s, 1 / drops.rate_Hz
    if abs(every / step - round(every / step)) > 1e-6:
        yield InputError(
            f"{where}rate_Hz",
            f"the sampling interval of {every:g} s is not a multiple of the time step of {step:g} s",
            f"Give {1 / step:g} Hz divided by a whole number, e.g. {1 / step / max(1, round(every / step)):g} .",
        )
