"""Limits of a run from the rules of a profile, at the speed of the run."""

from dataclasses import dataclass

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit, spread_limits
from pantocheck.conformance.cases.profile_file import BoundMissing, Profile, resolve_bounds
from pantocheck.conformance.input_files.input_error import InputError


@dataclass(frozen=True)
class ProfileLimits:
    """Rules of a profile with the values of the line that they need."""

    profile: Profile
    """Profile without rules that compare with a measured record."""
    uplift_space_mm: float | None
    """Space for the uplift of the contact wire at the supports [mm]."""

    def resolve(self, case: Case) -> tuple[tuple[Limit, ...], tuple[str, ...]]:
        """Limits of a case, and the reason of each rule that has no bound for it.

        Raises:
            InputError: The rules do not apply to the case.
        """
        where = f"profile '{self.profile.name}'"
        if self.profile.compares:
            raise InputError(where, "compares with a measured record", "Choose another profile.")
        if case.file.speed_km_h is None:
            raise InputError(where, f"needs a train, but {case.id} is a static case", "Choose cases with a speed.")
        if self.profile.filter != case.file.filter:
            raise InputError(where, f"has another filter than {case.id}", "Set the filter of the cases with `set`.")
        limits, missing = [], []
        for rule in self.profile.rule:
            try:
                values = {"uplift_space_mm": self.uplift_space_mm}
                lower, upper = resolve_bounds(rule, case.file.speed_km_h, values, None)
            except BoundMissing as reason:
                missing.append(f"{rule.quantity}: {reason}")
                continue
            stated = {"quantity": rule.quantity, "lower": lower, "upper": upper, "trust": rule.trust, "note": rule.note}
            limits.append(Limit.model_validate({**stated, "source": source_text(rule.source)}))
        return spread_limits(limits, len(case.pantographs)), tuple(missing)
