"""G1 to G3: Empties and chains of parents (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures
    from agents.protocol.structure import Structure, Thing


def _chains_end_at_the_root(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    for thing in structure.things:
        roots = {one.name for one in thing.roots}
        for mesh in (one for one in thing.meshes if not one.is_root):
            chain = list(structure.parents_of(mesh.name))
            if not chain or chain[-1] not in roots:
                ends = f"its chain of parents ends at {chain[-1]!r}" if chain else "it has no parent"
                yield G1.finding(
                    (mesh.name, thing.name),
                    f"The mesh {mesh.name!r} does not lead to the root of {thing.name!r}: {ends}.",
                )


def _roots_are_free(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    for thing in subject.structure.things:
        for root in thing.roots:
            if root.parent is not None:
                yield G2.finding(
                    (root.name, root.parent), f"The root {root.name!r} has a parent, {root.parent!r}."
                )


def _roots_in_their_object(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    used: dict[str, list[Thing]] = defaultdict(list)
    for thing in structure.things:
        for mesh in thing.meshes:
            root = _root_above(structure, mesh.name)
            if root is not None and thing not in used[root]:
                used[root].append(thing)
    for root in (one.name for one in subject.facts.objects if one.is_root):
        owners = structure.owners.get(root, ())
        strange = [thing for thing in used[root] if thing not in owners]
        for thing in strange:
            yield G3.finding(
                (root, thing.name), f"{root!r} is the root of {thing.name!r}, but is not in its collection."
            )
        if not owners and not strange:
            yield G3.finding((root,), f"The root {root!r} is in no object's collection.")
        if len(owners) > 1:
            names = ", ".join(repr(owner.name) for owner in owners)
            yield G3.finding(
                (root, *(owner.name for owner in owners)),
                f"The root {root!r} is in {len(owners)} objects: {names}.",
                fix="Give each object a root of its own, and link it into that object's collection only.",
            )


def _root_above(structure: Structure, name: str) -> str | None:
    """The first root in the chain of parents above a mesh."""
    above = (structure.objects.get(one) for one in structure.parents_of(name))
    return next((one.name for one in above if one is not None and one.is_root), None)


def _only_with_objects(subject: Subject) -> tuple[()]:
    if not subject.structure.things and not any(one.is_root for one in subject.facts.objects):
        raise Idle("no collection is an object of the protocol")
    return ()


G1 = Rule(
    "G1",
    "parented to the root",
    "hard",
    "Each mesh's chain of parents ends at the root of its object.",
    "A mesh that is not parented stays behind when its object moves.",
    "Parent the mesh to its object's root Empty, keeping its place in the world.",
    _chains_end_at_the_root,
    _only_with_objects,
)
G2 = Rule(
    "G2",
    "roots are free",
    "hard",
    "A root Empty has no parent.",
    "A root below another object is no anchor of its own; what travels with something says so by a constraint.",
    "Clear the root's parent, keeping its place in the world.",
    _roots_are_free,
    _only_with_objects,
)
G3 = Rule(
    "G3",
    "roots at home",
    "hard",
    "A root Empty is in its own object's collection.",
    "A root kept elsewhere is lost when the object's collection is moved, hidden or linked.",
    "Link the root Empty into its object's collection.",
    _roots_in_their_object,
    _only_with_objects,
)
RULES = (G1, G2, G3)
