"""One cause is one finding: what only follows from another finding is left out."""

from __future__ import annotations

from typing import Any

import pytest

from agents.protocol.causes import without_consequences
from agents.protocol.findings import Finding


def found(rule: str, *names: str, message: str = "It is wrong.", **more: Any) -> Finding:
    return Finding(rule, "hard", names, message, **more)


MISSING = found("R1", "Cup", measured=0.0)
HIDDEN = found("R1", "Cup")
FLOATS = found("R5", "Cup", "Table")
STILL = found("T2", "Ball", unit="m/s", measured=0.0)
LATE = found("T2", "Ball", unit="frames", measured=5.0)
UNBAKED = found("R19", "Cloth", "Sheet", message="The cloth cache of 'Cloth' is not baked.")
WORLD = found("R19", "Ball", "Box", message="The rigid-body cache is not baked.")


@pytest.mark.parametrize(
    ("cause", "consequence"),
    [
        (MISSING, found("R2", "Cup", outcome="undecided")),
        (FLOATS, found("V1", "Cup", "Table")),
        (STILL, found("T4", "Ball")),
        (STILL, found("T6", "Ball", outcome="undecided")),
        (UNBAKED, found("T1", "Sheet", message="The cloth cache of 'Sheet' is not baked.")),
        (WORLD, found("T1", message="The rigid-body cache is not baked.")),
    ],
)
def test_what_follows_from_another_finding_is_left_out(cause: Finding, consequence: Finding) -> None:
    assert without_consequences([consequence, cause]) == [cause]
    assert without_consequences([consequence]) == [consequence]


@pytest.mark.parametrize(
    ("finding", "other"),
    [
        (MISSING, found("R2", "Plate", outcome="undecided")),
        (MISSING, found("R3", "Cup")),
        (HIDDEN, found("R2", "Cup", outcome="undecided")),
        (FLOATS, found("V1", "Cup", "Saucer")),
        (FLOATS, found("V2", "Cup", "Table")),
        (STILL, found("T6", "Ball")),
        (LATE, found("T4", "Ball")),
        (UNBAKED, found("T1", message="The scene's last frame is 40; the plan says 60.")),
        (UNBAKED, found("T1", "Flag", message="The cloth cache of 'Flag' is not baked.")),
    ],
)
def test_findings_with_causes_of_their_own_stay(finding: Finding, other: Finding) -> None:
    assert without_consequences([finding, other]) == [finding, other]
