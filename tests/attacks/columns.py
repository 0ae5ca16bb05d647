"""The table's columns: which ways are tried in which sandbox, as whom."""

from __future__ import annotations

import os
import platform
from typing import TYPE_CHECKING

import pytest
from hosts import WHO
from table import WAYS
from way import KINDS

from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.confined_command import bubblewrap_fault

if TYPE_CHECKING:
    from _pytest.mark.structures import ParameterSet
    from attack import Attackers, Outcome
    from hosts import Host, Who
    from way import Kind, Way


def cells(kind: Kind) -> list[ParameterSet]:
    """The parameters of one sandbox's tests: (way, who).

    Every way is tried in both sandboxes. Behind bubblewrap, those against the same walls are tried as root and as a
    user by turns, and one that is the only one of its kind as both. Behind Landlock, all are tried as a user, and the
    first against some walls as root too, whose Blender starts there only where others may read its Python.

    `make test` leaves out those marked ``whole``: of those against the same walls, all but the first are then tried in
    one sandbox, by turns. So every way is tried, and all walls in every column.
    """
    alike: dict[tuple[frozenset[str], bool], list[Way]] = {}
    for way in WAYS:
        alike.setdefault((frozenset(way.attacks), way.once), []).append(way)

    def who_tries(way: Way) -> tuple[Who, ...]:
        if way.once:
            return _anybody(kind)
        others = alike[frozenset(way.attacks), False]
        turn = others.index(way)
        if kind == "landlock":
            return WHO if turn == 0 else ("user",)
        return WHO if len(others) == 1 or way.kinds != KINDS else (WHO[turn % 2],)

    def marks(way: Way) -> tuple[pytest.MarkDecorator, ...]:
        turn = alike[frozenset(way.attacks), way.once].index(way)
        # Two in a row have the same turn: behind bubblewrap, one of them is tried as root and one as a user.
        is_its_turn = turn == 0 or way.kinds != KINDS or KINDS[turn // 2 % len(KINDS)] == kind
        return () if is_its_turn else (pytest.mark.whole,)

    return [
        pytest.param(way, who, id=f"{way.name}-{kind}-{who}", marks=marks(way))
        for way in WAYS
        if kind in way.kinds
        for who in who_tries(way)
    ]


def _anybody(kind: Kind) -> tuple[Who, ...]:
    """One of the two, where they make no difference; between the sandboxes, both are tried if both can be."""
    return ("root",) if kind == "bubblewrap" and os.geteuid() == 0 else ("user",)


def skip_unless_it_works(kind: Kind) -> None:
    """Skips the test where that sandbox does not work."""
    if kind == "bubblewrap" and (fault := bubblewrap_fault()):
        pytest.skip(f"bubblewrap does not work here: {fault}")
    if kind == "landlock" and not confine_self.landlock_abi():
        pytest.skip("this kernel has no Landlock")
    if not confine_self.has_seccomp():
        pytest.skip("system calls cannot be closed on this machine")


def host_for(attackers: Attackers, way: Way, kind: Kind, who: Who, without: tuple[str, ...] = ()) -> Host:
    """The host that a way is tried on; skips the test where there can be none."""
    skip_unless_it_works(kind)
    if way.machine and platform.machine() != way.machine:
        pytest.skip(f"it is written for {way.machine}")
    if way.ready is not None and not way.ready():
        pytest.skip("this machine lacks what it attacks")
    host = attackers.host(kind, who, without, liar=bool(way.lies))
    if host.refused:
        pytest.skip(f"Blender does not start like this: {host.refused[:200]}")
    return host


def assert_held(attackers: Attackers, way: Way, kind: Kind, who: Who) -> None:
    """The way was tried, and nothing came of it."""
    outcome = attackers.carry_out(way, host_for(attackers, way, kind, who))
    assert not outcome.flaws, f"this is no attack: {said(outcome)}"
    assert not outcome.evidence, f"it succeeded: {said(outcome)}"


def said(outcome: Outcome) -> str:
    """An outcome for the reader of a failed test."""
    answers = [
        answer.get("message") or answer.get("text") or str(answer.get("data", ""))[:600]
        for answer in outcome.answers
    ]
    return "\n".join(
        [*outcome.evidence, *outcome.flaws, "The server replied:", *(answer[:800] for answer in answers)]
    )
