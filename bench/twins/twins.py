"""The second property: what only looks like a simulation is told from it.

From a scene in motion two twins are made, which look the same at every frame and in which nothing is simulated: one
moves by keys in the file, one is played from files. MPR must fall by as much as the predicates of solvers count in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.untrusted import NotScored
from bench.validate.proof import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit import ActorAudit, Audit
    from bench.facts import Scene
    from bench.validate.desk import Desk

KINDS = ("keys", "files")
# A twin looks the same if its pictures differ from the scene's by no more than one step of 256, or by no more than a
# quarter of what the scene without its physics differs: of gases, which are rendered with noise, that is the measure.
_STEP, _SHARE = 1 / 255, 0.25
_UNLIKE_SOLVERS = ("renderable", "dense_transform_keys", "animated_shape_keys")
_DIGITS = 6


def prove(desk: Desk) -> Iterator[Row]:
    """A row for each twin; none for a scene that stands still."""
    if desk.spec.category == "static":
        return
    gases = _has_gas(desk.reading.scene)
    desk.pictures(desk.original, gases=gases)
    bare = _difference_of_bare(desk, gases=gases)
    for kind in KINDS:
        try:
            yield _twin(desk, kind, bare, gases=gases)
        except NotScored as error:
            yield Row(name=kind, holds=False, why=str(error))


def solver_share(audit: Audit) -> float:
    """What the predicates of solvers count in MPR: the mean over actors of their share of its checks that apply."""
    shares = [_share(actor) for actor in audit.actors if actor.score is not None]
    return sum(shares) / len(shares) if shares else 0.0


def _share(actor: ActorAudit) -> float:
    counted = [check for check in actor.checks if check.outcome != "not_applicable"]
    return sum(check.predicate not in _UNLIKE_SOLVERS for check in counted) / len(counted)


def _twin(desk: Desk, kind: str, bare: float, *, gases: bool) -> Row:
    path, transferred = desk.make(f"twin-{kind}", "twin", kind=kind, files=f"twin-{kind}")
    desk.pictures(path, gases=gases)
    difference = desk.difference(desk.original, path)
    before, after = desk.reading.audit, desk.audit(path)
    share = solver_share(before)
    drop = (before.mpr or 0.0) - (after.mpr or 0.0)
    values: dict[str, Any] = {
        "transferred": {what: count for what, count in transferred.items() if count},
        "difference": round(difference, _DIGITS),
        "difference_without_physics": round(bare, _DIGITS),
        "rendered_by": "Cycles" if gases else "Workbench",
        "mpr": after.mpr,
        "spr": after.spr,
        "drop": round(drop, _DIGITS),
        "must_drop": round(share, _DIGITS),
    }
    wrong: list[str] = []
    if not drop > 0:
        wrong.append("it is not told from the scene")
    if drop < share - 10**-_DIGITS:
        wrong.append(f"MPR falls by {drop:.3f}, and must by {share:.3f}")
    if difference > max(_STEP, _SHARE * bare):
        wrong.append(f"it does not look the same: its pictures differ by {difference:.4f}")
    return Row(name=kind, holds=not wrong, why="; ".join(wrong), values=values)


def _difference_of_bare(desk: Desk, *, gases: bool) -> float:
    """How much the scene without its physics differs, which a twin has to make up for."""
    path, _ = desk.make("bare", "bare")
    desk.pictures(path, gases=gases)
    return desk.difference(desk.original, path)


def _has_gas(scene: Scene) -> bool:
    fluids = (modifier.fluid for one in scene.objects for modifier in one.of_type("FLUID"))
    return any(
        fluid is not None and fluid.domain is not None and fluid.domain.kind == "GAS" for fluid in fluids
    )
