"""Texts that differ in every run, and the files and values that are not compared.

A place is the path of the file below the folder of artefacts with the JSON pointer of the value, for example
`ac-simple/results.json/cases/0/verdict`.
"""

import re

PLACEHOLDERS = (
    (re.compile(r"sha256:(?:[0-9a-f]{64}|[0-9a-f]{30,63} [0-9a-f]+)\b"), "<digest>"),
    (re.compile(r"sha256[:-][0-9A-Za-z+/=]{12,64}"), "<digest>"),
    (re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)[0-9a-f]{12,64}(?:-dirty)?(?![\w.])"), "<digest>"),
    (re.compile(r"\b20\d\d-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d)?(?:\.\d+)?(?:Z| UTC|\+00:00)?)?"), "<date>"),
    (re.compile(r"\b([Pp]antocheck(?: reference simulator)?) \d+\.\d+(?:\.\w+)*(?:\+\w+)?"), r"\1 <version>"),
    (re.compile(r"(?i)\b(python|numpy|scipy|numba|typst|matplotlib|jinja2) \d+(?:\.\d+)+"), r"\1 <version>"),
    (re.compile(r"(?m)^(wall_s|version) = .*$"), r"\1 = <fact of the run>"),
)
"""Digests (broken over two lines, too), dates, versions and facts of a run."""

NOT_COMPARED = re.compile(
    r".*/campaign\.(?:sqlite|lock|parquet)"  # store, lock and copy of the values of campaign.json and campaign.csv
    r"|.*\.json(?:/.*)?/(?:wall_s|started|commit)"
    r"|.*\.json/(?:suite/version|system/version|platform/.*|renderer/.*)"
)
"""Places of facts of one run, of its version and of its platform."""


def replace(text: str) -> str:
    """Text with placeholders for digests, dates, versions and facts of a run."""
    for pattern, placeholder in PLACEHOLDERS:
        text = pattern.sub(placeholder, text)
    return text
