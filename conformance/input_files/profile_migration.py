"""Migration of profiles from version 1 to 2: a rule has no key `need` any more.

In version 1, `need = "if_known"` left a rule out whose quantity was not known. Such a rule could be met by delivering
less. In version 2, a quantity that is not known has the verdict `skip`.
"""

from collections.abc import Mapping
from typing import Any

from pantocheck.conformance.input_files.input_error import InputError


def migrate_profile_1(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Content of a profile of version 1 in version 2; parameters and errors as in `format_versions.Migration`."""
    rules = content.get("rule")
    if not isinstance(rules, list):
        return dict(content)
    for number, rule in enumerate(rules, 1):
        if isinstance(rule, Mapping) and rule.get("need") == "if_known":
            raise InputError(
                f"{where}, key rule[{number}].need",
                "'if_known' does not exist in version 2 of profiles",
                "Remove the key or the rule: without need, a quantity that is not known is a skip. Then write schema = "
                '"pantocheck.profile/2".',
            )
    return {**content, "rule": [_drop_need(rule) for rule in rules]}


def _drop_need(rule: Any) -> Any:
    """Rule without `need = "required"`, which every rule of version 2 is; other values are refused by the model."""
    if not isinstance(rule, Mapping) or rule.get("need") != "required":
        return rule
    return {key: value for key, value in rule.items() if key != "need"}
