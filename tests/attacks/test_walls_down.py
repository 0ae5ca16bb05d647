"""Attacks succeed once the walls that stop them are taken down: else it would prove nothing that they fail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from columns import host_for, said
from table import WAYS

from simworlds.sandbox.walls import WALLS

if TYPE_CHECKING:
    from attack import Attackers
    from way import Kind, Way

pytestmark = pytest.mark.blender

_ALL = [way for way in WAYS if {*way.attacks} <= {*WALLS} and not way.once]
# Each in one sandbox, in turn.
_CASES = [
    pytest.param(way, kind, id=f"{way.name}-{kind}")
    for number, way in enumerate(_ALL)
    for kind in (way.kinds[number % len(way.kinds)],)
]


@pytest.mark.parametrize(("way", "kind"), _CASES)
def test_succeeds_without_its_walls(way: Way, kind: Kind, attackers: Attackers) -> None:
    who = "root" if "uid" in way.attacks else "user"
    host = host_for(attackers, way, kind, who, tuple(sorted(way.attacks)))
    outcome = attackers.carry_out(way, host)
    assert outcome.evidence, f"nothing came of it: {said(outcome)}"
