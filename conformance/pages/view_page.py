"""Pages of `pantocheck view`: passages of results, as moving pictures where their wires are known, and mass drops."""

import math
from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_case_figures
from pantocheck.conformance.pages.document_facts import name_system
from pantocheck.conformance.pages.passage_figure import ENLARGED, ILLUSTRATION, draw_instant, draw_passage
from pantocheck.conformance.results.motion_format import LineScene
from pantocheck.conformance.results.results_format import Results


def build_view(results: Results) -> doc.Document:
    """Page with the moving pictures of the cases; a case without one has the figures of its signals."""
    sections = []
    for number, case in enumerate(results.cases):
        anchor = f"case-{number + 1}"
        figures = tuple(draw_passage(case, number, anchor)) or tuple(draw_case_figures(case, number, anchor))
        if figures:
            blocks = (doc.Paragraph((doc.Code(case.id),)), doc.Figures(figures))
            sections.append(doc.Section(case.title, blocks, anchor=anchor))
    header = doc.PlainHeader("Passage", f"{name_system(results)}. {ILLUSTRATION}")
    return doc.Document("Passage", header, tuple(sections), results, doc.find_date(results))


def build_drop_view(title: str, scenes: Sequence[LineScene]) -> doc.Document:
    """Page with the moving pictures of the mass drops of a case."""
    blocks = [
        doc.Section(scene.names[0], (doc.Paragraph((doc.Code(scene.id),)), doc.Figures((draw_scene(scene, number),))))
        for number, scene in enumerate(scenes)
    ]
    return replace(doc.build_plain_document("Mass drops", f"{title}. {ILLUSTRATION}", blocks), scenes=tuple(scenes))


def draw_scene(scene: LineScene, number: int) -> doc.Figure:
    """First picture of a scene, which a script replaces: a mass at its release, or the middle of a compared passage.

    `number` is the index of the scene.
    """
    motion, shape, name = scene.motions[0], scene.line_shape, scene.names[0]
    enlarged = f"Motion {ENLARGED} times enlarged over the heights. {ILLUSTRATION}"
    if scene.together:
        frame = motion.wires[0].rise_mm.frames // 2
        others = ", ".join(scene.names[1:])
        time = f"{motion.start_s + frame * motion.step_s:.3f} s"
        caption = f"Passage of {name} at {time}, and at the same place, dashed, {others}. {enlarged}"
    else:
        frame = max(0, math.floor(-motion.start_s / motion.step_s))
        caption = f"{name}: the line under the mass, at the release. {enlarged}"
    shown = scene.motions[1:] if scene.together else ()
    svg = draw_instant(motion, shape, (shape.supports_m[0], shape.supports_m[0]), frame, shown)
    curves = doc.Curves("passage", number)
    return doc.Figure(svg, caption, caption, anchor=f"scene-{number + 1}", curves=curves)
