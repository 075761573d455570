"""Kinds of forged HTML pages: texts, figures, styles, scripts and the embedded results."""

import random
import re
from collections.abc import Callable

Forge = Callable[[str, random.Random], str]


def swap(old: str, new: str) -> Forge:
    """Replace the first occurrence of a text."""
    return lambda page, _: page.replace(old, new, 1)


def swap_all(old: str, new: str) -> Forge:
    """Replace every occurrence of a text before the embedded results."""

    def forge(page: str, _: random.Random) -> str:
        head, mark, rest = page.partition('<script type="application/json"')
        return head.replace(old, new) + mark + rest

    return forge


def insert_style(text: str) -> Forge:
    """Append rules to the style sheet."""
    return swap("</style>", f"\n{text}</style>")


def insert(text: str) -> Forge:
    """Insert markup at the beginning of the body."""
    return swap("<body>", f"<body>{text}")


def change_cell(page: str, chance: random.Random) -> str:
    """Change a number in a cell of a table."""
    cells = list(re.finditer(r"<td[^>]*>[^<]*?(\d+\.\d)", page))
    match = chance.choice(cells)
    digit = str((int(page[match.end(1) - 1]) + 3) % 10)
    return page[: match.end(1) - 1] + digit + page[match.end(1) :]


def change_figure(page: str, chance: random.Random) -> str:
    """Change a coordinate of a curve."""
    start = page.index("<path", page.index("<figure"))
    numbers = list(re.finditer(r"\d+\.\d+", page[start : start + 3000]))
    match = chance.choice(numbers)
    return page[: start + match.start()] + "100.5" + page[start + match.end() :]


def remove_row(page: str, _: random.Random) -> str:
    """Delete the row of a failing criterion."""
    rows = re.findall(r"<tr[^>]*>(?:(?!</tr>).)*?verdict fail(?:(?!</tr>).)*?</tr>", page, re.S)
    return page.replace(rows[0], "", 1)


def change_data(page: str, _: random.Random) -> str:
    """Change a verdict in the embedded results."""
    head, mark, rest = page.partition('<script type="application/json"')
    return head + mark + rest.replace('"verdict":"fail"', '"verdict":"pass"')


HTML_FORGERIES: dict[str, Forge] = {
    "word of the verdict in the heading": swap("FAIL</span></h1>", "PASS</span></h1>"),
    "every word of a verdict": swap_all("FAIL", "PASS"),
    "colour of the verdict": swap('class="top fail"', 'class="top pass"'),
    "title": swap("<title>FAIL", "<title>PASS"),
    "number in a table": change_cell,
    "coordinate of a curve": change_figure,
    "row of a failing criterion": remove_row,
    "letters that look alike": swap_all("FAIL", "F\u0391IL"),
    "reversed text": swap_all("FAIL", "\u202eLIAF\u202c"),
    "rows hidden by style": insert_style("tr:has(.fail) { display: none }"),
    "word replaced by style": insert_style(".verdict.fail { font-size: 0 } .verdict.fail::after { content: 'PASS' }"),
    "page covered by style": insert_style(
        "body::before { content: 'PASS'; position: fixed; inset: 0; background: #fff }"
    ),
    "style of an element": swap("<main>", '<main style="visibility:hidden">'),
    "failing row commented out": lambda page, chance: page.replace("<main>", "<main><!--", 1).replace(
        "</main>", "--></main>", 1
    ),
    "script": insert("<script>document.title='PASS'</script>"),
    "event handler": swap("<main>", '<main onclick="alert(1)">'),
    "image from the network": insert('<img src="https://example.org/pass.png" alt="PASS">'),
    "style sheet from the network": swap("</head>", '<link rel="stylesheet" href="https://example.org/a.css"></head>'),
    "frame": insert('<iframe srcdoc="PASS"></iframe>'),
    "base address": swap("</head>", '<base href="https://example.org/"></head>'),
    "forwarding": swap("</head>", '<meta http-equiv="refresh" content="0;url=https://example.org/"></head>'),
    "form": insert('<form action="https://example.org/"><button>PASS</button></form>'),
    "security policy removed": lambda page, _: re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page),
    "security policy weakened": swap("default-src 'none'", "default-src *"),
    "date": lambda page, _: re.sub(r"20\d\d(-\d\d-\d\d \d\d:\d\d:\d\d UTC)", r"2031\1", page),
    "embedded verdict": change_data,
    "embedded results removed": lambda page, _: re.sub(
        r'<script type="application/json".*?</script>', "", page, flags=re.S
    ),
    "embedded results twice": lambda page, _: re.sub(
        r'(<script type="application/json".*?</script>)', r"\1\1", page, flags=re.S
    ),
    "line breaks": lambda page, _: page.replace("\n", "\r\n"),
    "text behind the end": lambda page, _: page + "<p>PASS</p>\n",
}
"""Kinds of forged HTML pages by name."""
