"""Numbers with their nouns, for everything that a person reads."""


def count_noun(number: int, noun: str, plural: str | None = None) -> str:
    """Write a number of things: `1 pantograph`, `2 pantographs`.

    Args:
        number: Number of things.
        noun: Noun for one thing.
        plural: Noun for several things; by default the noun with an s.

    Returns:
        The number and the noun that belongs to it.
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
