"""Texts that name a criterion: the number that a limit applies to, and its bounds."""


def name_value(quantity: str, item: int | None) -> str:
    """Name of a value: the quantity, with the number of the item if it has several values.

    Parameters
    ----------
    quantity : str
        Name of the quantity.
    item : int or None
        Number of the item, from 1.

    Returns
    -------
    str
        Name such as `std_force_N` or `damping_ratio[2]`.
    """
    return f"{quantity}[{item}]" if item else quantity


def format_bounds(lower: float | None, upper: float | None, digits: int = 12) -> str:
    """Bounds of a limit in ASCII characters.

    Parameters
    ----------
    lower, upper : float or None
        Bounds in the unit of the quantity; None if there is no such bound.
    digits : int
        Significant digits; 12 show an input number in its shortest form.

    Returns
    -------
    str
        `26 to 31`, `<= 225`, `>= 30`, `= 0` or `none`.
    """
    low, high = (None if bound is None else f"{bound:.{digits}g}" for bound in (lower, upper))
    if low is None:
        return "none" if high is None else f"<= {high}"
    if high is None:
        return f">= {low}"
    return f"= {low}" if lower == upper else f"{low} to {high}"
