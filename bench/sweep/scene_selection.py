"""Selects scenes by id, category, level, pattern or named set."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from bench.scenes.spec import BadSpec, specs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bench.scenes.spec import Spec

# The paper's ablations are of one scene for each mechanism and level; it does not say which. These are the first ones.
SETS: dict[str, Callable[[Spec], bool]] = {
    "all": bool,
    "dynamic": lambda spec: spec.category != "static",
    "ablation": lambda spec: spec.category != "static" and spec.id.endswith("_01"),
}


def select_scenes(names: Iterable[str]) -> tuple[Spec, ...]:
    """The scenes that match any of ``names``, in the benchmark's order. Raises BadSpec for a name that matches none.

    A name is an id (``cloth_D1_01``), a category, a level (``D2``), a cell (``cloth_D1``), a pattern (``*_D?_01``), or
    a set: all, dynamic, ablation. One string may hold several, with commas.
    """
    wanted = [name.strip() for several in names for name in several.split(",") if name.strip()]
    every = specs()
    selected = {spec.id for name in wanted for spec in _matching(name, every)}
    return tuple(spec for spec in every if spec.id in selected)


def _matching(name: str, every: Sequence[Spec]) -> list[Spec]:
    if name in SETS:
        return [spec for spec in every if SETS[name](spec)]
    matches = [
        spec for spec in every if name in (spec.category, spec.level, spec.cell) or fnmatchcase(spec.id, name)
    ]
    if not matches:
        sets = ", ".join(SETS)
        raise BadSpec(
            f"{name[:80]!r} matches no scene: give an id, a category, a level, a pattern, or one of {sets}."
        )
    return matches
