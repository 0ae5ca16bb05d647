"""Valid scenes are found valid, and what is broken in them is found broken."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest
from mutating import measure_rates
from mutations import KINDS
from whole import IS_WHOLE

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

COUNT = (6 if IS_WHOLE else 4) * len(KINDS)  # the script beside it makes more


def test_breaches_are_found_by_the_rules_that_own_them_and_valid_scenes_raise_no_alarm(
    session: LiveSession, capsys: pytest.CaptureFixture[str]
) -> None:
    rates = measure_rates(session, COUNT)
    with capsys.disabled():
        sys.stdout.write(f"\n{rates.table()}\n")
    missed = [row for row in rates.log().splitlines() if row.endswith("NOTHING")]
    assert len(rates.outcomes) == COUNT
    assert not [finding.message for finding in rates.alarms]
    assert rates.detection >= 0.98, missed
