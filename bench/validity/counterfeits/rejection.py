"""The second property: what only looks like a simulation is told from it.

From a scene in motion two twins are made, which look the same at every frame and in which nothing is simulated: one
moves by keys in the file, one is played from files. MPR must fall by as much as the predicates of solvers count in it.
"""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import NotScored
from bench.validity.proof import Row

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.audit.audit import ActorAudit, Audit
    from bench.audit.facts import Scene
    from bench.validity.variant_builder import Desk

KINDS = ("keys", "files")
# A twin looks the same if its pictures differ from the scene's by no more than a tenth of what the scene without its
# physics differs. Gases are rendered with noise: there it may be as much as with another seed, but not half of that.
_SHARE, _MOST = 0.1, 0.5
_SEEN = 1e-4  # of what is shown, a scene's physics makes more than this
_UNLIKE_SOLVERS = ("renderable", "dense_transform_keys", "animated_shape_keys")
_DIGITS = 6


def prove(desk: Desk) -> Iterator[Row]:
    """A row for each twin; none for a scene that stands still."""
    if desk.spec.category == "static":
        return
    look = _Look(desk)
    for kind in KINDS:
        try:
            yield _twin(desk, kind, look)
        except NotScored as error:
            yield Row(name=kind, holds=False, why=str(error))


def solver_share(audit: Audit) -> float:
    """What the predicates of solvers count in MPR: the mean over actors of their share of its checks that apply."""
    shares = [_share(actor) for actor in audit.actors if actor.score is not None]
    return sum(shares) / len(shares) if shares else 0.0


def _share(actor: ActorAudit) -> float:
    counted = [check for check in actor.checks if check.outcome != "not_applicable"]
    return sum(check.predicate not in _UNLIKE_SOLVERS for check in counted) / len(counted)


class _Look:
    """How much variants look like the scene on the desk: differences of pictures, red, green and blue from 0 to 1.

    Workbench renders them; Cycles does where there is a gas, or where Workbench shows nothing of the physics, as of
    water behind glass.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        bare, _ = desk.make("bare", "bare")
        ways = (True,) if _has_gas(desk.reading.scene) else (False, True)
        for self._cycles in ways:
            desk.pictures(desk.original, cycles=self._cycles)
            self.without_physics = self.difference(bare)
            if self.without_physics >= _SEEN:
                break
        self.noise = self._noise() if self._cycles else 0.0

    def difference(self, path: Path) -> float:
        """Of a variant from the scene."""
        self._desk.pictures(path, cycles=self._cycles)
        return self._desk.difference(self._desk.original, path)

    def _noise(self) -> float:
        """Of the scene from itself, with another seed."""
        again = self._desk.original.with_stem("again")
        shutil.copy2(self._desk.original, again)
        self._desk.pictures(again, cycles=True, seed=1)
        return self._desk.difference(self._desk.original, again)

    @property
    def allowed(self) -> float:
        """How much what looks the same may differ."""
        return max(_SHARE * self.without_physics, min(self.noise, _MOST * self.without_physics))

    @property
    def told(self) -> dict[str, Any]:
        """For reports."""
        return {
            "rendered_by": "Cycles" if self._cycles else "Workbench",
            "difference_without_physics": round(self.without_physics, _DIGITS),
            "noise": round(self.noise, _DIGITS),
        }


def _twin(desk: Desk, kind: str, look: _Look) -> Row:
    path, transferred = desk.make(f"twin-{kind}", "twin", kind=kind, files=f"twin-{kind}")
    difference = look.difference(path)
    before, after = desk.reading.audit, desk.audit(path)
    share = solver_share(before)
    drop = (before.mpr or 0.0) - (after.mpr or 0.0)
    values: dict[str, Any] = {
        "transferred": {what: count for what, count in transferred.items() if count},
        "difference": round(difference, _DIGITS),
        **look.told,
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
    if look.without_physics < _SEEN:
        wrong.append(
            "the pictures show nothing of the physics, so they cannot tell whether it looks the same"
        )
    elif difference > look.allowed:
        wrong.append(f"it does not look the same: its pictures differ by {difference:.4f}")
    return Row(name=kind, holds=not wrong, why="; ".join(wrong), values=values)


def _has_gas(scene: Scene) -> bool:
    fluids = (modifier.fluid for one in scene.objects for modifier in one.of_type("FLUID"))
    return any(
        fluid is not None and fluid.domain is not None and fluid.domain.kind == "GAS" for fluid in fluids
    )
