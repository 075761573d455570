"""Assessment of a record against the installed profile of its name."""

from collections.abc import Iterator

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.grading.case_identity import limits_digest, rules_digest
from pantocheck.conformance.results.results_format import CaseResult


def compare_profile(profile: Profile, result: CaseResult) -> Iterator[str]:
    """Differences of an assessment from the profile of the library.

    The bounds of most rules depend on the record, so that only `--record` recomputes them.

    Args:
        profile: Installed profile.
        result: Result of an assessment by a profile of this name.

    Yields:
        One sentence per difference.
    """
    if result.stated_limits_digest != json_digest([rules_digest(profile), limits_digest(())]):
        yield "digest of the rules: another one in the library"
    if result.run.filter.model_dump() != profile.filter.model_dump():
        yield "the filter differs from that of the library"
    if result.record is not None and result.record.demanded != (profile.verification == "demanded"):
        yield "whether verification is demanded differs from the library"
    if result.limits_digest != result.stated_limits_digest:
        return  # limits of a user replace rules; `limit_changes` names the weakened ones
    graded = {row.quantity for row in result.criteria}
    for rule in profile.rule:
        if rule.quantity not in graded:
            yield f"{rule.quantity}: a rule in the library, no criterion in the certificate"
    trusts = {rule.quantity: rule.trust for rule in profile.rule}
    for row in result.criteria:
        if row.quantity in trusts and row.trust != trusts[row.quantity] and not row.is_drift:
            yield f"{row.quantity}: trust '{trusts[row.quantity]}' in the library, '{row.trust}' in the certificate"
