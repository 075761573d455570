"""Named rules of the mean contact force: the formulas of the profiles of the library."""

from pantocheck.conformance.cases.force_law import MeanForceLaw, MeanForceRule
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names


def resolve_rule(file: PantographFile, where: str) -> PantographFile:
    """Replace the name of a rule by its formula, with the trust and the source of the profile.

    Args:
        file: Content of a pantograph file.
        where: Name of the file in messages.

    Returns:
        The same content; a force law of the kind `mean_force_rule` becomes one of the kind `mean_force`.

    Raises:
        InputError: The library has no profile of this name, or the profile has no formula for the mean force.
    """
    if not isinstance(file.force_law, MeanForceRule):
        return file
    rules, name = list_mean_force_rules(), file.force_law.profile
    if name not in rules:
        raise InputError(
            f"{where}, key force_law.profile",
            f"no profile {name!r} of the library has a formula for mean_force_N",
            suggest_names(name, list(rules)),
        )
    return file.model_copy(update={"force_law": rules[name]})


def list_mean_force_rules() -> dict[str, MeanForceLaw]:
    """Largest mean contact force as a function of speed that each profile of the library accepts, by profile."""
    # Imported here: a list of cases whose pantographs name no rule is shown without profiles.
    from pantocheck.conformance.cases.profile_file import SpeedFormula, list_profiles, load_profile

    return {
        name: MeanForceLaw(
            kind="mean_force",
            constant_N=rule.upper.constant,
            quadratic_N_h2_km2=rule.upper.per_speed_squared,
            above_km_h=rule.upper.above_km_h or 0.0,
            trust=rule.trust,
            source=rule.source,
            note=f"rule of the profile {name}",
        )
        for name in list_profiles()
        for rule in load_profile(name).rule
        if rule.quantity == "mean_force_N" and isinstance(rule.upper, SpeedFormula)
    }
