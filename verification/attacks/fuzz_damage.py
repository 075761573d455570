"""Damage of a file: bytes flipped, cut, doubled, or replaced by tokens that break parsers."""

import random
import re

TOKENS = tuple(
    text.encode()
    for text in (
        "nan", "inf", "-inf", "1e999", "-1e308", "1e-320", "0", "-1", "9" * 400, "true", "null", '""', "[]", "{}",
        "[[", "'''", '"""', "\\u0000", "\x00", "\ufeff", "\u202e", "é", "\r", "\n\n", "=", ",", ",,", ";", "#", "0x1p9",
        "../../etc/passwd", "C:\\x", "1_000", "1.5.2", "2026-11-20", "1979-05-27T07:32:00Z", "." * 50, "a" * 5000,
        "pantograph = 99", "\n[line]\n", "\n[[limit]]\n", "speed_km_h = 0.0\n", "speed_km_h = 1e300\n",
    )
)  # fmt: skip


def damage(content: bytes, chance: random.Random) -> bytes:
    """Damage a file at one or more random places."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 4, 16))):
        place = chance.randrange(len(data) + 1)
        span = chance.choice((1, 1, 4, 30, 1000))
        match chance.randrange(8):
            case 0:
                data[place : place + 1] = bytes([chance.randrange(256)])
            case 1:
                del data[place : place + span]
            case 2:
                data = data[:place]
            case 3:
                data[place:place] = data[place : place + span] * chance.choice((1, 2, 50))
            case 4:
                data[place : place + chance.choice((0, 1, 3))] = chance.choice(TOKENS)
            case 5:
                data[place : place + span] = chance.randbytes(min(span, 50))
            case 6:
                data = _replace_number(data, chance)
            case _:
                data = _swap_lines(data, chance)
    return bytes(data)


def _replace_number(data: bytearray, chance: random.Random) -> bytearray:
    """Replace a number by another one, which random bytes seldom do."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?", data))
    if not found:
        return data
    number = chance.choice(found)
    other = chance.choice((b"0", b"-1", b"1e9", b"1e300", b"nan", b"99999999999999999999", b"0.5", b"-0.0", b"2"))
    return data[: number.start()] + other + data[number.end() :]


def _swap_lines(data: bytearray, chance: random.Random) -> bytearray:
    lines = data.split(b"\n")
    i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return bytearray(b"\n".join(lines))
