"""Proves that the audit rejects counterfeits: scenes that look like a simulation and are not.

Of each scene in motion two counterfeits are made, which look the same at every frame and simulate nothing: one moves by
keys in the file, one is played from files. MPR must fall at least by the share that solver predicates have in it.
"""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import NotScored
from bench.validity.proof import ProofRow

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.audit.audit import ActorAudit, Audit
    from bench.audit.facts import Scene
    from bench.validity.variant_builder import VariantBuilder

KINDS = ("keys", "files")
# A counterfeit looks the same if its pictures differ from the scene's by at most a tenth of what the scene without its
# physics differs. Gases are rendered with noise: there it may differ as much as with another seed, but at most half of
# what the scene without physics does.
_SHARE, _MOST = 0.1, 0.5
_SEEN = 1e-4  # the least difference that a scene's physics makes to the pictures
_NOT_OF_SOLVERS = ("renderable", "dense_transform_keys", "animated_shape_keys")
_DIGITS = 6


def prove(builder: VariantBuilder) -> Iterator[ProofRow]:
    """A row for each counterfeit; none for a static scene."""
    if builder.spec.category == "static":
        return
    appearance = _Appearance(builder)
    for kind in KINDS:
        try:
            yield _counterfeit(builder, kind, appearance)
        except NotScored as error:
            yield ProofRow(name=kind, holds=False, why=str(error))


def solver_share(audit: Audit) -> float:
    """The share of solver predicates in MPR: the mean over actors of their share of the checks that apply."""
    shares = [_share(actor) for actor in audit.actors if actor.score is not None]
    return sum(shares) / len(shares) if shares else 0.0


def _share(actor: ActorAudit) -> float:
    counted = [check for check in actor.checks if check.outcome != "not_applicable"]
    return sum(check.predicate not in _NOT_OF_SOLVERS for check in counted) / len(counted)


class _Appearance:
    """Compares pictures of variants with those of the scene: differences of red, green and blue from 0 to 1.

    Rendered by Workbench; by Cycles where there is a gas, or where Workbench shows nothing of the physics, such as
    water behind glass.
    """

    def __init__(self, builder: VariantBuilder) -> None:
        self._builder = builder
        without_physics, _ = builder.make("without-physics", "remove_physics")
        engines = (True,) if _has_gas(builder.reading.scene) else (False, True)
        for self._cycles in engines:
            builder.render(builder.original, cycles=self._cycles)
            self.without_physics = self.difference(without_physics)
            if self.without_physics >= _SEEN:
                break
        self.noise = self._noise() if self._cycles else 0.0

    def difference(self, path: Path) -> float:
        """The difference of a variant from the scene."""
        self._builder.render(path, cycles=self._cycles)
        return self._builder.difference(self._builder.original, path)

    def _noise(self) -> float:
        """The difference of the scene from itself with another seed."""
        again = self._builder.original.with_stem("again")
        shutil.copy2(self._builder.original, again)
        self._builder.render(again, cycles=True, seed=1)
        return self._builder.difference(self._builder.original, again)

    @property
    def allowed(self) -> float:
        """How much a variant that looks the same may differ."""
        return max(_SHARE * self.without_physics, min(self.noise, _MOST * self.without_physics))

    @property
    def values(self) -> dict[str, Any]:
        """For reports."""
        return {
            "rendered_by": "Cycles" if self._cycles else "Workbench",
            "difference_without_physics": round(self.without_physics, _DIGITS),
            "noise": round(self.noise, _DIGITS),
        }


def _counterfeit(builder: VariantBuilder, kind: str, appearance: _Appearance) -> ProofRow:
    path, transferred = builder.make(
        f"counterfeit-{kind}", "counterfeit", kind=kind, files=f"counterfeit-{kind}"
    )
    difference = appearance.difference(path)
    before, after = builder.reading.audit, builder.audit(path)
    share = solver_share(before)
    drop = (before.mpr or 0.0) - (after.mpr or 0.0)
    values: dict[str, Any] = {
        "transferred": {what: count for what, count in transferred.items() if count},
        "difference": round(difference, _DIGITS),
        **appearance.values,
        "mpr": after.mpr,
        "spr": after.spr,
        "drop": round(drop, _DIGITS),
        "must_drop": round(share, _DIGITS),
    }
    wrong: list[str] = []
    if not drop > 0:
        wrong.append("the audit does not tell it from the scene")
    if drop < share - 10**-_DIGITS:
        wrong.append(f"MPR falls by {drop:.3f} and must fall by {share:.3f}")
    if appearance.without_physics < _SEEN:
        wrong.append("the pictures show nothing of the physics, so they cannot prove that it looks the same")
    elif difference > appearance.allowed:
        wrong.append(f"it does not look the same: its pictures differ by {difference:.4f}")
    return ProofRow(name=kind, holds=not wrong, why="; ".join(wrong), values=values)


def _has_gas(scene: Scene) -> bool:
    fluids = (modifier.fluid for obj in scene.objects for modifier in obj.of_type("FLUID"))
    return any(
        fluid is not None and fluid.domain is not None and fluid.domain.kind == "GAS" for fluid in fluids
    )
