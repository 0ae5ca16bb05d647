"""Attacks succeed once the walls that stop them are taken down: else it would prove nothing that they fail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from columns import host_for, said
from table import WAYS

from simworlds.sandbox.confinement.walls import WALLS

if TYPE_CHECKING:
    from attack import Attackers
    from way import Kind, Way

pytestmark = pytest.mark.blender

# Some of each wall, in one sandbox or the other.
_BUBBLEWRAP = """
    open overwrite make-a-link save-a-scene a-checkpoint-of-its-own overwrite-what-may-be-read
    set-proc-sys-kernel-core-pattern set-the-place-among-the-killed be-root
    have-any-capability see-that-it-is-there names-of-sockets kill-by-tkill connect
    share-memory-by-key fork spawn start-a-program a-file-in-memory handle-its-own-faults another-personality
    outlive-the-server take-private-memory take-memory many-files
"""
_LANDLOCK = """
    open-a-key-in-the-home-folder through-a-link by-openat2 truncate open-to-truncate
    set-the-flags-of-what-may-be-read a-file-beside-the-workspace the-target-of-a-link an-attribute send-a-datagram
    send-from-a-pair-to-a-path send-a-descriptor-from-a-pair open-a-socket-of-netlink clone change-an-owner
    join-groups kill kill-by-descriptor kill-by-sigqueue slow-it-down pin-it ring-the-kernel add-a-key names-by-fanotify
    a-filter-of-its-own lower-the-limit-of-nofile one-large-file-by-reservation many-bytes-in-nameless-files
"""
_BY_NAME = {way.name: way for way in WAYS}


def _cases() -> list[object]:
    """Those without the same walls follow each other, so that each Blender is started once.

    `make test` leaves out those marked ``whole``: all but the first against each wall, in the sandboxes by turns.
    """
    samples: tuple[tuple[Kind, str], ...] = (("bubblewrap", _BUBBLEWRAP), ("landlock", _LANDLOCK))
    cases = [
        (kind, sorted(_BY_NAME[name].attacks), _BY_NAME[name])
        for kind, names in samples
        for name in names.split()
    ]
    shown: set[str] = set()
    telling: set[str] = set()
    turns = {kind: [way for one, _, way in cases if one == kind] for kind, _ in samples}
    for _, walls, way in sorted(cases, key=lambda case: turns[case[0]].index(case[2])):
        if new := {*walls} - shown:
            shown |= new
            telling.add(way.name)
    cases.sort(key=lambda case: case[:2])
    return [
        pytest.param(
            way, kind, id=f"{way.name}-{kind}", marks=() if way.name in telling else pytest.mark.whole
        )
        for kind, _, way in cases
    ]


@pytest.mark.parametrize(("way", "kind"), _cases())
def test_succeeds_without_its_walls(way: Way, kind: Kind, attackers: Attackers) -> None:
    assert {*way.attacks} <= {*WALLS}
    who = "root" if "uid" in way.attacks else "user"
    outcome = attackers.carry_out(way, host_for(attackers, way, kind, who, tuple(sorted(way.attacks))))
    assert outcome.evidence, f"nothing came of it: {said(outcome)}"
