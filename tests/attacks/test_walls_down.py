"""Attacks succeed once the walls that stop them are taken down: else it would prove nothing that they fail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from columns import host_for, said
from table import WAYS
from way import KINDS

from simworlds.sandbox.walls import WALLS

if TYPE_CHECKING:
    from attack import Attackers
    from way import Kind, Way

pytestmark = pytest.mark.blender

_CASES = [
    pytest.param(way, kind, id=f"{way.name}-{kind}")
    for way in WAYS
    for kind in KINDS
    if kind in way.kinds and {*way.attacks} <= {*WALLS}
]


@pytest.mark.parametrize(("way", "kind"), _CASES)
def test_succeeds_without_its_walls(way: Way, kind: Kind, attackers: Attackers) -> None:
    host = host_for(attackers, way, kind, "user", tuple(sorted(way.attacks)))
    outcome = attackers.carry_out(way, host)
    assert outcome.evidence, f"nothing came of it: {said(outcome)}"
