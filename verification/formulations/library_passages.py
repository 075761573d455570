"""Ids of the library cases with a train that are compared with finer meshes and other formulations."""

PASSAGES = (
    "en50318-2002/250",
    "en50318-2002/300",
    "en50318-2018/ac-simple/275",
    "en50318-2018/ac-simple/320",
    "en50318-2018/ac-simple/275-twin",
    "en50318-2018/ac-simple/320-twin",
    "en50318-2018/ac-stitched/275",
    "en50318-2018/ac-stitched/320",
)

OTHER_PASSAGES = ("force-law/300", "vovan2015/contact-force")
"""Library cases with a train that run on request."""
