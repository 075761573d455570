"""Pages of moving passages, which the page of this name embeds."""

from pathlib import Path

from site_pages.start_pictures import MASS_DROP, ONE_PANTOGRAPH, TWO_PANTOGRAPHS, run_pantocheck

OVERLAP = (
    *("line.geometry.spans=14", "line.section=[{spans=8},{spans=9}]", "line.overlap={spans=3,anchor_rise_m=0.5}"),
    "evaluated_spans=[6,8]",
)

PASSAGES = {
    "below": (ONE_PANTOGRAPH,),
    "above": (ONE_PANTOGRAPH, "speed_km_h=480"),
    "overlap": ("en50318-2002/300", *OVERLAP),
    "in-phase": (TWO_PANTOGRAPHS, "spacing_m=[140.0]"),
    "out-of-phase": (TWO_PANTOGRAPHS, "spacing_m=[180.0]"),
    "contact-loss": ("en50318-2002/300", "speed_km_h=340"),
    "mass-drop": (MASS_DROP,),
}
"""Case of each passage, and the changes of its inputs."""


def write_passages(folder: Path) -> None:
    """Write the page of each passage."""
    for name, (case, *changes) in PASSAGES.items():
        options = [text for change in changes for text in ("--set", change)]
        run_pantocheck("view", case, *options, "--out", str(folder / "passages" / f"{name}.html"))
