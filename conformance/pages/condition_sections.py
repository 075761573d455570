"""Conditions of the values of a case: contact of the band from 20 to 50 Hz, untraced inputs, resolving power.

A value of this band has a mark wherever a table of the case shows it; the condition stands once in the section.
"""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.frequency_section import frequency_blocks, mute_row
from pantocheck.conformance.pages.words import format_signed, name_pantograph, quantity_label, read_words, replace_minus
from pantocheck.conformance.results.case_facts_format import ConditionFacts
from pantocheck.conformance.results.results_format import CaseResult, InputGroup

CONDITIONED = "rms_20_50_N"
"""Quantity that depends on the contact more than on any other input."""
BAND_MARK = "‡"
"""Mark of its values."""
SPRINGLESS = {"hertz": "contact by the law of Hertz", "constraint": "contact by a constraint"}
"""Contact laws without a spring, as a pantograph file states them."""
SHOWN = ("std_force_N", "rms_0_5_N", "rms_5_20_N", CONDITIONED)
"""Quantities of the table; results.json has all."""


def find_contacts(case: CaseResult) -> list[InputGroup]:
    """Contacts of the pantographs that a case states."""
    return [group for group in case.inputs if group.group.split(".")[-1] == "contact"]


def describe_condition(case: CaseResult) -> str:
    """Sentence on the contact of the values from 20 to 50 Hz; empty if the case has no such value or contact."""
    contacts = find_contacts(case)
    if not contacts or not any(CONDITIONED in values for values in case.quantities.values()):
        return ""
    texts = dict.fromkeys(f"{_describe_law(group)}, {_describe_source(group)}" for group in contacts)
    effects = [_describe_effect(case, condition.name) for condition in case.conditions if condition.is_contact]
    effect = f" They change by {'; '.join(filter(None, effects))}." if any(effects) else ""
    return f"{BAND_MARK} Values from 20 to 50 Hz are conditional on {' and on '.join(texts)}.{effect}"


def _describe_law(group: InputGroup) -> str:
    law, value = str(group.values.get("law", "spring")), group.values.get("stiffness_N_m")
    if law in SPRINGLESS:
        return SPRINGLESS[law]
    return f"a contact spring of {value / 1000:g} kN/m" if isinstance(value, float | int) else "another contact"


def _describe_source(group: InputGroup) -> str:
    """Trust of a contact in words."""
    if group.trust == "provisional":
        return "which is not traced"
    meaning = read_words()["trust"][group.trust]["meaning"]
    return f"whose source is {group.trust} ({meaning})"


def _describe_effect(case: CaseResult, name: str) -> str:
    """Change of the band by a condition, of each pantograph."""
    (condition,) = (condition for condition in case.conditions if condition.name == name)
    changes = [values[CONDITIONED] for values in condition.changes.values() if CONDITIONED in values]
    texts = " and ".join(f"{format_signed(change)} %" for change in changes)
    return f"{texts} with {replace_minus(name)}" if changes else ""


def condition_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Condition of the values from 20 to 50 Hz, and sentences on errors of the inputs."""
    sentences = tuple(doc.SmallPrint(text) for text in (describe_condition(case), *case.input_studies) if text)
    return (*frequency_blocks(case), *sentences)


def build_condition_section(case: CaseResult) -> tuple[doc.Section, ...]:
    """Table of the changes by inputs that are not traced or left open; empty if none is stored."""
    if not case.conditions:
        return ()
    owners = sorted({owner for condition in case.conditions for owner in condition.changes if owner != "0"})
    columns = (
        doc.Column("Other input", 3),
        *(doc.Column(f"{quantity_label(name)} [%]", 1.5, number=True) for name in SHOWN),
    )
    rows = tuple(
        (_name_condition(row), *(_join_changes(row, name, owners) for name in SHOWN)) for row in case.conditions
    )
    joined = f" Values of {' / '.join(map(name_pantograph, owners))}." if len(owners) > 1 else ""
    text = (
        "Changes of the values by inputs that are not traced, or that a case leaves open, computed with the reference "
        f"simulator. They are not part of the uncertainty.{joined}"
    )
    return (doc.Section("Conditions of the values", (doc.Table(columns, rows), doc.SmallPrint(text))),)


def _name_condition(condition: ConditionFacts) -> doc.RichText:
    """Name of a condition, with the reason why the case does not support it."""
    name = replace_minus(condition.name)
    return (
        name if condition.not_applicable is None else (name, doc.Remark(f"not applicable: {condition.not_applicable}"))
    )


def _join_changes(condition: ConditionFacts, quantity: str, owners: Sequence[str]) -> str:
    """Changes of a quantity, of every pantograph; a dash for one without a change."""
    changes = [condition.changes.get(owner, {}).get(quantity) for owner in owners]
    return " / ".join("–" if change is None else format_signed(change) for change in changes)


def mark_values(case: CaseResult, blocks: Sequence[doc.Block]) -> tuple[doc.Block, ...]:
    """Blocks of a case with the mark at every row on the band from 20 to 50 Hz, and unsupported rows in grey."""
    return tuple(_mark_block(case, block) for block in blocks)


def _mark_block(case: CaseResult, block: doc.Block) -> doc.Block:
    if isinstance(block, doc.Section):
        return replace(block, blocks=mark_values(case, block.blocks))
    if isinstance(block, doc.Table):
        return replace(block, rows=tuple(_mark_row(case, row) for row in block.rows))
    return block


def _mark_row(case: CaseResult, row: tuple[doc.RichText, ...]) -> tuple[doc.RichText, ...]:
    """Row with the mark of its condition, grey above the supported frequency of the pantograph in its second cell."""
    marked = (mark_cell(row[0]), *row[1:]) if describe_condition(case) else row
    owner = row[1] if len(row) > 1 and isinstance(row[1], str) and row[1].isdigit() else "0"
    return mute_row(case.supported, owner, marked)


def mark_cell(cell: doc.RichText) -> doc.RichText:
    """First cell of a row; marked if it names the quantity."""
    parts = cell if isinstance(cell, tuple) else (cell,)
    if doc.Code(CONDITIONED) in parts or parts[0] == quantity_label(CONDITIONED):
        return (parts[0], *parts[1:2], f" {BAND_MARK}", *parts[2:])
    return cell
