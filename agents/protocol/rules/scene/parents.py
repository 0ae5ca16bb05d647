"""G1 to G3: root Empties and chains of parents (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures
    from agents.protocol.structure import LogicalObject, SceneStructure


def _detached_meshes(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    for obj in structure.logical_objects:
        roots = {root.name for root in obj.roots}
        for mesh in (mesh for mesh in obj.meshes if not mesh.is_root):
            chain = list(structure.parents_of(mesh.name))
            if not chain or chain[-1] not in roots:
                ends = f"its chain of parents ends at {chain[-1]!r}" if chain else "it has no parent"
                yield G1.finding(
                    (mesh.name, obj.name),
                    f"The mesh {mesh.name!r} is not parented to the root of {obj.name!r}: {ends}.",
                )


def _roots_with_parents(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    for obj in context.structure.logical_objects:
        for root in obj.roots:
            if root.parent is not None:
                yield G2.finding(
                    (root.name, root.parent), f"The root {root.name!r} has a parent, {root.parent!r}."
                )


def _misplaced_roots(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    used_by: dict[str, list[LogicalObject]] = defaultdict(list)
    for obj in structure.logical_objects:
        for mesh in obj.meshes:
            root = _root_above(structure, mesh.name)
            if root is not None and obj not in used_by[root]:
                used_by[root].append(obj)
    for root in (item.name for item in context.facts.objects if item.is_root):
        owners = structure.owners.get(root, ())
        elsewhere = [obj for obj in used_by[root] if obj not in owners]
        for obj in elsewhere:
            yield G3.finding(
                (root, obj.name), f"{root!r} is the root of {obj.name!r}, but not in its collection."
            )
        if not owners and not elsewhere:
            yield G3.finding((root,), f"The root {root!r} is not in the collection of any object.")
        if len(owners) > 1:
            names = ", ".join(repr(owner.name) for owner in owners)
            yield G3.finding(
                (root, *(owner.name for owner in owners)),
                f"The root {root!r} is in {len(owners)} objects: {names}.",
                fix="Give each object its own root, and link it into that object's collection only.",
            )


def _root_above(structure: SceneStructure, name: str) -> str | None:
    """The first root in the chain of parents above a mesh."""
    above = (structure.objects.get(parent) for parent in structure.parents_of(name))
    return next((item.name for item in above if item is not None and item.is_root), None)


def _needs_objects(context: RuleContext) -> tuple[()]:
    if not context.structure.logical_objects and not any(item.is_root for item in context.facts.objects):
        raise NotApplicable("no collection is an object (L3)")
    return ()


G1 = Rule(
    "G1",
    "parented to the root",
    "hard",
    "Each mesh's chain of parents ends at the root of its object.",
    "A mesh that is not parented stays behind when its object moves.",
    "Parent the mesh to its object's root Empty, keeping its place in the world.",
    _detached_meshes,
    _needs_objects,
)
G2 = Rule(
    "G2",
    "root without parent",
    "hard",
    "A root Empty has no parent.",
    "A parented root no longer places its object on its own; use a constraint for what moves with something.",
    "Clear the root's parent, keeping its place in the world.",
    _roots_with_parents,
    _needs_objects,
)
G3 = Rule(
    "G3",
    "root in its object",
    "hard",
    "A root Empty is in its own object's collection.",
    "A root kept elsewhere is lost when the object's collection is moved, hidden or linked.",
    "Link the root Empty into its object's collection.",
    _misplaced_roots,
    _needs_objects,
)
RULES = (G1, G2, G3)
