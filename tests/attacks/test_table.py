"""The table of attacks itself, and what of a sandbox is not a matter of trying."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import pytest
from columns import cells, skip_unless_it_works
from hosts import WHO
from outside import rights_of
from table import WAYS
from way import KINDS, Server

from simworlds.sandbox.confinement.walls import WALLS

if TYPE_CHECKING:
    from attack import Attackers
    from hosts import Who
    from way import Kind

# A wall that stands by itself: the environment is made anew, whatever the sandbox.
_ALWAYS = {"environment"}


def test_every_wall_is_attacked() -> None:
    attacked = {aim for way in WAYS for aim in way.attacks}
    assert {*WALLS} - _ALWAYS <= attacked <= {*WALLS, *get_args(Server)}


def test_a_part_of_the_table_has_every_way_and_all_walls_in_every_column() -> None:
    table: list[tuple[str, Any, Any]] = []
    part: list[tuple[str, Any, Any]] = []
    for kind in KINDS:
        for cell in cells(kind):
            way, who = cell.values
            table.append((kind, way, who))
            part += [] if cell.marks else table[-1:]
    assert {way.name for _, way, _ in part} == {way.name for way in WAYS}
    for way in WAYS:
        if not way.once:
            alike = {other.name for other in WAYS if {*other.attacks} == {*way.attacks} and not other.once}
            columns = [
                {(kind, who) for kind, one, who in rows if one.name in alike} for rows in (table, part)
            ]
            assert columns[0] == columns[1], way.attacks


@pytest.mark.blender
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("who", WHO)
def test_the_worker_has_no_rights(kind: Kind, who: Who, attackers: Attackers) -> None:
    """Or Blender does not start, and the error says what to do."""
    skip_unless_it_works(kind)
    host = attackers.host(kind, who)
    if host.refused:
        assert "bubblewrap" in host.refused or "another user" in host.refused, host.refused
        return
    rights = rights_of(host.process)
    assert {rights[name] for name in ("CapInh", "CapPrm", "CapEff", "CapAmb")} == {"0" * 16}
    assert (rights["NoNewPrivs"], rights["Seccomp"], rights["oom_score_adj"]) == ("1", "2", "1000")
    if who == "root":
        assert "0" not in rights["Uid"].split()
