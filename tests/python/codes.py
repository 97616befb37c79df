"""What tests ask of refusals and warnings: their codes, for sentences are free to change."""

import pytest
import tripatch


def refused(code):
    """A context that a refusal with this code ends."""

    def has_code(refusal):
        assert refusal.code == code, f"{refusal.code}: {refusal.reason}"
        return True

    return pytest.raises(tripatch.Refusal, check=has_code)


def says(report, *codes):
    """Whether a report has a warning with one of these codes."""
    return any(each.code in codes for each in report.warnings)
