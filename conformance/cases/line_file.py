"""Line files: geometry, wires, connectors and damping of a line."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field

from pantocheck.conformance.cases.damping_file import Damping
from pantocheck.conformance.cases.dropper_schedule import (
    DropperHeights,
    DropperLengths,
    DropperPositions,
    DropperPresags,
    DropperSchedule,
    find_schedule_problems,
)
from pantocheck.conformance.cases.geometry import GeometryTable, ListedSpans
from pantocheck.conformance.cases.irregularity_table import IrregularityTable, SpectralIrregularity
from pantocheck.conformance.cases.line_layout import LineLayout, build_layout
from pantocheck.conformance.cases.section_tables import (
    SECTIONS,
    OverlapTable,
    SectionPlace,
    SectionTable,
    find_span_problems,
    place_sections,
)
from pantocheck.conformance.cases.support_tables import (
    MOST_SPANS,
    ClampMass,
    MessengerSupportTable,
    SteadyArmTable,
    overlay_changes,
)
from pantocheck.conformance.cases.track_table import CurveTable, TrackTable, check_curves
from pantocheck.conformance.cases.variation import VARIATION, ListedLengthChanges, Variation
from pantocheck.conformance.cases.wire_changes import (
    CHANGES,
    MOST_CHANGES,
    BendingStiffness,
    ContactWireChange,
    MassPerLength,
    PointMassTable,
    Tension,
    WireChange,
    check_changes,
    check_point_masses,
)
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import NO_FEATURE, Feature
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    Positive,
    SourcedTable,
    is_absent,
    validation_problem,
)

DROPPERS = Feature("droppers")
DROPPER_MASS = Feature("dropper_mass", bool)

Area = Annotated[float | None, Field(gt=0, le=1000, description="cross-section [mm2]"), NO_FEATURE]


class WireTable(SourcedTable):
    """Contact wire or messenger wire; the values are those of one wire, also of two parallel wires."""

    number: Annotated[Literal[1, 2], Field(description="number of parallel wires"), Feature("twin_wires")] = 1
    spacing_m: Annotated[
        float | None,
        Field(gt=0, le=1, description="lateral distance between parallel wires [m]"),
        Feature("twin_wires"),
    ] = None
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    area_mm2: Area = None


class ContactWireTable(WireTable):
    """Contact wire; the values are those of one wire, also of two parallel wires."""

    change: Annotated[
        tuple[ContactWireChange, ...],
        Field(strict=False, max_length=MOST_CHANGES, description="worn or other stretches", exclude_if=is_absent),
        CHANGES,
    ] = ()
    irregularity: Annotated[
        IrregularityTable | None,
        Field(description="heights that a pantograph feels in addition to those at rest", exclude_if=is_absent),
        Feature("irregularity"),
    ] = None


class MessengerWireTable(WireTable):
    """Messenger wire; the values are those of one wire, also of two parallel wires."""

    axial_stiffness_EA_N: Annotated[
        float | None,
        Field(gt=0, le=1e9, description="axial stiffness EA; needed with messenger_support.along_track = 'fixed' [N]"),
        NO_FEATURE,  # it acts with messenger_wire_held_along_track only
    ] = None
    change: Annotated[
        tuple[WireChange, ...],
        Field(strict=False, max_length=MOST_CHANGES, description="other stretches", exclude_if=is_absent),
        CHANGES,
    ] = ()


class StitchWireTable(SourcedTable):
    """Stitch wire, clamped to the messenger wire on both sides of a support; it carries the nearest droppers."""

    length_m: Annotated[Positive, Field(description="distance between its clamps, symmetric to the support [m]")]
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    clamp_kg: Annotated[ClampMass, Feature("stitch_wire")] = 0.0


class DropperTable(SourcedTable):
    """Droppers: bars that carry tension, but no compression; their schedule holds for spans without another one."""

    x_m: DropperPositions
    presag_m: DropperPresags = None
    contact_wire_height_m: DropperHeights = None
    length_m: DropperLengths = None
    stiffness_N_m: Annotated[float | None, Field(gt=0, description="stiffness of a taut dropper [N/m]"), DROPPERS] = (
        None
    )
    axial_stiffness_EA_N: Annotated[
        float | None,
        Field(gt=0, description="axial stiffness EA of a dropper, for a stiffness of EA / length [N]"),
        DROPPERS,
    ] = None
    mass_kg: Annotated[float | None, Field(ge=0, le=20, description="mass of a dropper [kg]"), DROPPER_MASS] = None
    mass_kg_m: Annotated[
        float | None, Field(ge=0, le=20, description="mass per length of a dropper [kg/m]"), DROPPER_MASS
    ] = None
    clamp_on_messenger_kg: Annotated[ClampMass, DROPPER_MASS] = 0.0
    clamp_on_contact_kg: Annotated[ClampMass, DROPPER_MASS] = 0.0

    @cross_check
    def _check_schedule(self) -> Problems:
        yield from find_schedule_problems(self.x_m, self.presag_m, self.contact_wire_height_m, self.length_m)

    @cross_check
    def _check_stiffness(self) -> Problems:
        if (self.stiffness_N_m is None) == (self.axial_stiffness_EA_N is None):
            yield validation_problem(
                "stiffness_N_m",
                "the stiffness of the droppers is missing or given twice",
                "Give either stiffness_N_m or axial_stiffness_EA_N.",
            )

    @cross_check
    def _check_mass(self) -> Problems:
        if self.mass_kg is not None and self.mass_kg_m is not None:
            yield validation_problem(
                "mass_kg", "the mass of the droppers is given twice", "Give either mass_kg or mass_kg_m."
            )

    @property
    def schedule(self) -> DropperSchedule:
        """Schedule of the spans that name no other."""
        return DropperSchedule.model_construct(
            x_m=self.x_m,
            presag_m=self.presag_m,
            contact_wire_height_m=self.contact_wire_height_m,
            length_m=self.length_m,
        )


class LineFile(InputTable):
    """Content of a line file."""

    title: Annotated[str, Field(description="title in reports", max_length=200)]
    geometry: GeometryTable
    contact_wire: ContactWireTable
    messenger_wire: MessengerWireTable
    stitch_wire: Annotated[StitchWireTable | None, Feature("stitch_wire")] = None
    droppers: DropperTable
    steady_arm: SteadyArmTable
    messenger_support: MessengerSupportTable
    damping: Damping
    point_mass: Annotated[
        tuple[PointMassTable, ...],
        Field(strict=False, max_length=MOST_CHANGES, description="masses on the wires", exclude_if=is_absent),
        Feature("point_masses"),
    ] = ()
    section: Annotated[
        tuple[SectionTable, ...] | None,
        Field(
            strict=False,
            min_length=2,
            max_length=MOST_SPANS,
            description="tension sections in running order; default: one section from end to end",
            exclude_if=is_absent,
        ),
        SECTIONS,
    ] = None
    overlap: Annotated[OverlapTable | None, Field(exclude_if=is_absent), SECTIONS] = None
    track: Annotated[
        TrackTable | None,
        Field(description="curves and cant of the track; default: straight", exclude_if=is_absent),
        Feature("curves", lambda track: track is not None and bool(track.curve)),
    ] = None
    variation: Annotated[
        Variation | None,
        Field(description="variation of the line after it was built", exclude_if=is_absent),
        VARIATION,
    ] = None
    note: Annotated[str | None, Field(description="remark for the reader", max_length=4000)] = None

    @property
    def section_places(self) -> tuple[SectionPlace, ...]:
        """Places of the tension sections; one from end to end if the file has none."""
        if self.section is None or self.overlap is None:
            return (SectionPlace(1, 0, self.geometry.spans),)
        return place_sections(self.section, self.overlap.spans)

    @property
    def overlaps(self) -> tuple[tuple[float, float], ...]:
        """Start and end of every overlap [m, m]."""
        limits = self.geometry.span_limits
        return tuple((limits[after.first], limits[before.last]) for before, after in pairwise(self.section_places))

    def section_file(self, place: SectionPlace) -> Self:
        """Same line with the wires of one section."""
        if self.section is None:
            return self
        own = self.section[place.number - 1]
        wires = {
            "contact_wire": overlay_changes(self.contact_wire, own.contact_wire),
            "messenger_wire": overlay_changes(self.messenger_wire, own.messenger_wire),
        }
        return self.model_copy(update=wires)

    @property
    def middle_span(self) -> int:
        """Number of the span in the middle of the first tension section without its overlap, from 1."""
        overlap = 0 if self.overlap is None else self.overlap.spans
        return self.geometry.shorten(self.section_places[0].last - overlap).middle_span

    def shorten(self, spans: int) -> Self:
        """Same line with the first spans only, as one tension section."""
        return self.model_copy(update={"geometry": self.geometry.shorten(spans), "section": None, "overlap": None})

    @property
    def dropper_schedules(self) -> tuple[DropperSchedule, ...]:
        """Dropper schedule of every span."""
        return self.geometry.choose_schedules(self.droppers.schedule)

    @property
    def layout(self) -> LineLayout:
        """Spans and supports with all their values, in either form of the geometry."""
        return build_layout(self.geometry, self.dropper_schedules, self.steady_arm, self.messenger_support)

    @cross_check
    def _droppers_lie_in_their_spans(self) -> Problems:
        spans = enumerate(zip(self.geometry.span_lengths, self.dropper_schedules, strict=True), 1)
        # Spans of one length with one schedule have the same problems.
        schedules = {(self._schedule_key(number), span): schedule for number, (span, schedule) in spans}
        for (key, span), schedule in schedules.items():
            for i, x in enumerate(schedule.x_m, 1):
                if x >= span:
                    yield validation_problem(
                        f"{key}.x_m[{i}]",
                        f"{x:g} m is not inside the span of {span:g} m",
                        f"Give positions between 0 and {span:g} m, from the start of the span.",
                    )

    @cross_check
    def _check_stitch_wire(self) -> Problems:
        span = self.geometry.shortest_span
        if self.stitch_wire is not None and self.stitch_wire.length_m >= span:
            yield validation_problem(
                "stitch_wire.length_m",
                f"{self.stitch_wire.length_m:g} m is not shorter than the span of {span:g} m",
                "Give a length below that of a span; neighbouring stitch wires must not overlap.",
            )

    @cross_check
    def _check_numbers_of_wires(self) -> Problems:
        if self.messenger_wire.number > self.contact_wire.number:
            yield validation_problem(
                "messenger_wire.number",
                "two messenger wires carry one contact wire",
                "Set messenger_wire.number = 1 or contact_wire.number = 2.",
            )

    @cross_check
    def _check_axial_stiffness(self) -> Problems:
        holding = self.layout.supports_fixed_along_track
        if holding and self.messenger_wire.axial_stiffness_EA_N is None:
            yield validation_problem(
                "messenger_wire.axial_stiffness_EA_N",
                f"support {holding[0]} holds the messenger wire along the track, but its axial stiffness is not given",
                "Give messenger_wire.axial_stiffness_EA_N, or set messenger_support.along_track = 'free'.",
            )

    @cross_check
    def _check_changes(self) -> Problems:
        yield from check_changes("contact_wire.change", self.contact_wire.change, self.geometry.length)
        yield from check_changes("messenger_wire.change", self.messenger_wire.change, self.geometry.length)

    @cross_check
    def _check_point_masses(self) -> Problems:
        yield from check_point_masses(self.point_mass, self.geometry.length, self.overlaps)

    @property
    def curves(self) -> tuple[CurveTable, ...]:
        """Curves of the track."""
        return () if self.track is None else self.track.curve

    @cross_check
    def _check_curves(self) -> Problems:
        yield from check_curves(self.curves, self.geometry.length)
        if self.curves and self.layout.supports_fixed_along_track:
            yield validation_problem(
                "messenger_support.along_track",
                "'fixed' is not possible on a track with curves",
                "Set along_track = 'free', or leave out the curves.",
            )

    @cross_check
    def _check_irregularity(self) -> Problems:
        table = self.contact_wire.irregularity
        if isinstance(table, SpectralIrregularity):
            yield from table.check_resolution(self.geometry.length)

    @cross_check
    def _check_overlap(self) -> Problems:
        if (self.section is None) != (self.overlap is None):
            key, other = ("overlap", "section") if self.overlap is None else ("section", "overlap")
            yield validation_problem(key, f"the table is missing beside {other}", "Give both, or none of them.")

    @cross_check
    def _check_terminations(self) -> Problems:
        for number, section in enumerate(self.section or (), 1):
            if section.holding_points > 1 and self.messenger_wire.axial_stiffness_EA_N is None:
                yield validation_problem(
                    "messenger_wire.axial_stiffness_EA_N",
                    f"section {number} holds the messenger wire along the track at {section.holding_points} points, "
                    "but its axial stiffness is not given",
                    "Give messenger_wire.axial_stiffness_EA_N, or end the section with weights.",
                )

    @cross_check
    def _check_sections(self) -> Problems:
        if self.section is not None and self.overlap is not None:
            yield from find_span_problems(self.section, self.overlap.spans, self.geometry.spans)

    @cross_check
    def _check_length_changes(self) -> Problems:
        table = None if self.variation is None else self.variation.droppers
        if isinstance(table, ListedLengthChanges):
            found = [len(span) for span in table.length_change_m]
            needed = [len(schedule.x_m) for schedule in self.dropper_schedules]
            if found != needed:
                yield validation_problem(
                    "variation.droppers.length_change_m",
                    f"{len(found)} lists with {sum(found)} changes for {len(needed)} spans with {sum(needed)} droppers",
                    "Give one list per span, with one change per dropper.",
                )

    @cross_check
    def _check_stagger_changes(self) -> Problems:
        if self.variation is not None and self.variation.supports is not None and not self.layout.has_stagger:
            yield validation_problem(
                "variation.supports",
                "varies the stagger of a line without a stagger",
                "Give geometry.stagger_contact_wire_m, or leave out variation.supports.",
            )

    def _schedule_key(self, number: int) -> str:
        """Key of the dropper schedule of a span."""
        if not isinstance(self.geometry, ListedSpans) or self.geometry.span_list[number - 1].droppers is None:
            return "droppers"
        droppers = self.geometry.span_list[number - 1].droppers
        named = isinstance(droppers, str)
        return f"geometry.schedule.{droppers}" if named else f"geometry.span_list[{number}].droppers"
