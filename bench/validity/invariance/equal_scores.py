"""The fourth property: how a scene is organised, named and measured does not change what it scores."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import JobRefused, NotScored
from bench.validity.invariance.actor_names import cast_of
from bench.validity.proof import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import Audit
    from bench.validity.variant_builder import Desk

GUISES = {
    "ungrouped": "hierarchies and collections dissolved",
    "grouped": "each actor's objects in a collection of its name, themselves called nothing",
    "renamed": "actors called by a synonym",
    "rescaled": "a hundred times as large, in hundredths of a metre",
    "instanced": "still things shown as instances of collections outside of the scene",
    "joined": "still things of several meshes made one",
}
TOLERANCE = 0.02
_DIGITS = 6


def prove(desk: Desk) -> Iterator[Row]:
    """A row for each guise; those that a scene cannot be put into do not apply."""
    before = desk.audit(desk.original)
    cast = cast_of(desk.spec, desk.reading.scene, desk.reading.found)
    for guise in GUISES:
        try:
            path, _ = desk.make(guise, "guise", guise=guise, cast=cast)
            after = desk.audit(path)
        except JobRefused as error:
            yield Row(name=guise, holds=None, why=str(error))
        except NotScored as error:
            yield Row(name=guise, holds=False, why=str(error))
        else:
            yield _row(guise, before, after)


def _row(guise: str, before: Audit, after: Audit) -> Row:
    apart: dict[str, float | None] = {
        "mpr": _apart(before.mpr, after.mpr),
        "spr": _apart(before.spr, after.spr),
    }
    values: dict[str, Any] = {"mpr": after.mpr, "spr": after.spr, "apart": apart}
    same = (before.mpr is None) == (after.mpr is None) and (before.spr is None) == (after.spr is None)
    holds = same and all(each is None or abs(each) <= TOLERANCE for each in apart.values())
    return Row(name=guise, holds=holds, why="" if holds else _lost(after), values=values)


def _apart(before: float | None, after: float | None) -> float | None:
    return None if before is None or after is None else round(after - before, _DIGITS)


def _lost(after: Audit) -> str:
    """What does not hold in a guise, in words."""
    checks = [
        f"{actor.name}: {check.predicate}"
        for actor in after.actors
        for check in actor.checks
        if check.outcome == "failed"
    ]
    relations = [f"{one.a} {one.type} {one.b}" for one in after.relations if one.outcome != "holds"]
    return ", ".join([*checks, *relations]) or (after.not_scored or "")
