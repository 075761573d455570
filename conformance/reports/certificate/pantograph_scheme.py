"""Schemes of the pantographs of a case that are chains; equal chains are drawn once in a document."""

from collections import defaultdict

from pantocheck.conformance.reports.document import Figure
from pantocheck.conformance.reports.figures.chain_figure import DrawnChain, draw_chain
from pantocheck.conformance.reports.page_text import format_plain
from pantocheck.conformance.results.case_facts_format import StoredValue, StoredValues
from pantocheck.conformance.results.results_format import CaseResult

DRAWN_KEYS = ("masses_kg", "stiffness_N_m", "damping_N_s_m")
"""Keys of the values of a chain, base to head."""


def scheme_figures(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[Figure, ...]:
    """Scheme of every chain of a case that no earlier case has.

    Args:
        case: The case. Older results have no values of inputs, and no scheme.
        earlier: Cases that stand before it in the report.
    """
    known = {chain for other in earlier for chain in _read_chains(other)}
    return tuple(_describe(chain, names) for chain, names in _read_chains(case).items() if chain not in known)


def _read_chains(case: CaseResult) -> dict[DrawnChain, list[str]]:
    """Chains of a case with the names of their pantographs."""
    values = {group.group: group.values for group in case.inputs}
    chains: dict[DrawnChain, list[str]] = defaultdict(list)
    for group, content in values.items():
        name = group.removesuffix(".chain")
        chain = _read_chain(content, values.get(f"{name}.contact", {})) if name != group else None
        if chain is not None:
            chains[chain].append(name)
    return chains


def _read_chain(values: StoredValues, contact: StoredValues) -> DrawnChain | None:
    """Chain of a group of inputs; None where values are missing, or are stored as a range."""
    masses, stiffness, damping = (_list_numbers(values.get(key)) for key in DRAWN_KEYS)
    contact_stiffness = _list_numbers(contact.get("stiffness_N_m"))
    if not masses or len({len(masses), len(stiffness), len(damping)}) > 1 or len(contact_stiffness) != 1:
        return None
    names = _list_names(values.get("names"), len(masses))
    # The uplift force acts on the lowest mass unless the file names another one (key uplift_force_on).
    point = values.get("uplift_force_on", 1.0)
    lifted = names.index(point) if point in names else int(point) - 1 if isinstance(point, float) else 0
    return DrawnChain(masses, stiffness, damping, names, lifted, contact_stiffness[0])


def _list_numbers(value: StoredValue | None) -> tuple[float, ...]:
    """Numbers of a stored value; a single number is a list of one; nothing for other values."""
    listed = value if isinstance(value, list) else [value]
    numbers = tuple(number for number in listed if isinstance(number, float))
    return numbers if len(numbers) == len(listed) else ()


def _list_names(value: StoredValue | None, size: int) -> tuple[str, ...]:
    names = tuple(map(str, value if isinstance(value, list) else [value]))
    return names if value is not None and len(names) == size else tuple(f"mass {n}" for n in range(1, size + 1))


def _describe(chain: DrawnChain, pantographs: list[str]) -> Figure:
    numbers = [name.removeprefix("pantograph").strip() for name in pantographs]
    owner = f"Pantograph {numbers[0]}".rstrip() if len(numbers) == 1 else f"Pantographs {' and '.join(numbers)}"
    caption = f"{owner}: masses, springs and dampers, from base to head."
    parts = ", ".join(f"{name} {format_plain(mass)} kg" for name, mass in zip(chain.names, chain.masses, strict=True))
    return Figure(draw_chain(chain), f"{caption} {parts}.", caption, wide=False)
