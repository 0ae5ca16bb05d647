"""C1 to C6: the layout of collections (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import NO_ROLES, NotApplicable, Rule, RuleContext
from agents.protocol.structure import NUMBER, SCENE
from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures


def _objects_without_system(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    for obj in structure.logical_objects:
        if not structure.systems_of(obj.collection):
            yield C1.finding((obj.name,), f"The object {obj.name!r} is not in any system.")


def _nested_systems(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    for system in context.structure.systems:
        if SCENE not in system.parents:
            where = f"in {', '.join(map(repr, system.parents))}" if system.parents else "not in the scene"
            yield C2.finding(
                (system.name,), f"The system {system.name!r} is {where}; it must be directly in the scene."
            )


def _meshes_without_owner(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    for mesh in structure.meshes:
        owners = structure.owners.get(mesh.name, ())
        if not owners:
            yield C3.finding((mesh.name,), f"The mesh {mesh.name!r} is not in any object.", measured=0.0)
        elif len(owners) > 1:
            names = ", ".join(repr(owner.name) for owner in owners)
            yield C3.finding(
                (mesh.name,),
                f"The mesh {mesh.name!r} is in {len(owners)} objects: {names}.",
                measured=float(len(owners)),
            )


def _root_count(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    for obj in context.structure.logical_objects:
        roots = [root.name for root in obj.roots if root.type == "EMPTY"]
        wrong = [root.name for root in obj.roots if root.type != "EMPTY"]
        if len(roots) != 1 or wrong:
            names = f" ({', '.join(roots)})" if len(roots) > 1 else ""
            also = f"; {', '.join(map(repr, wrong))} is tagged as root but is not an Empty" if wrong else ""
            yield C4.finding(
                (obj.name, *(root.name for root in obj.roots)),
                f"The object {obj.name!r} has {len(roots)} root Empties{names}{also}; it needs exactly one.",
                measured=float(len(roots)),
            )


def _numbered_names(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    for collection in context.facts.collections:
        if collection.role and NUMBER.search(collection.name):
            yield C5.finding(
                (collection.name,),
                f"The collection {collection.name!r} has a name with a duplicate's number.",
            )


def _missing_ground(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    system = structure.collections.get(GROUND)
    if system is None or system.role != "system":
        yield C6.finding((GROUND,), "The scene has no system named 'ground'.", measured=0.0)
    elif not structure.grounds:
        yield C6.finding((GROUND,), "The system 'ground' holds no object.", measured=0.0)


def _needs_tags(context: RuleContext) -> tuple[()]:
    if not any(collection.role for collection in context.facts.collections):
        raise NotApplicable(NO_ROLES)
    return ()


def _needs_objects(context: RuleContext) -> tuple[()]:
    if not context.structure.logical_objects:
        _needs_tags(context)
        raise NotApplicable("no collection is an object (L3)")
    return ()


def _needs_systems(context: RuleContext) -> tuple[()]:
    if not context.structure.systems:
        _needs_tags(context)
        raise NotApplicable("no collection is a system (L2)")
    return ()


def _needs_meshes(context: RuleContext) -> tuple[()]:
    if not context.structure.meshes:
        raise NotApplicable("the scene has no mesh")
    return ()


C1 = Rule(
    "C1",
    "object in a system",
    "hard",
    "Every object (L3) is in at least one system (L2).",
    "An object outside every system is missed when the scene is checked, shown or changed by system.",
    "Link the object's collection into a system's collection.",
    _objects_without_system,
    _needs_objects,
)
C2 = Rule(
    "C2",
    "system at the root",
    "hard",
    "Every system (L2) is directly under the scene's own collection.",
    "With nested systems it is ambiguous which system an object belongs to.",
    "Link the collection into the scene's collection and unlink it from the others.",
    _nested_systems,
    _needs_systems,
)
C3 = Rule(
    "C3",
    "mesh in one object",
    "hard",
    "Every mesh is in exactly one object (L3).",
    "A mesh without an object is never checked; a mesh in two objects moves with neither.",
    "Link the mesh into the collection of the object that it belongs to, and only there.",
    _meshes_without_owner,
    _needs_meshes,
)
C4 = Rule(
    "C4",
    "one root",
    "hard",
    "Every object (L3) has exactly one Empty tagged is_object_root.",
    "Without exactly one root, the object cannot be placed or moved as a whole.",
    "Keep one Empty with is_object_root, in the object's collection, and untag or remove the others.",
    _root_count,
    _needs_objects,
)
C5 = Rule(
    "C5",
    "no numbered names",
    "hard",
    "No collection of the protocol has a name such as Chair.001.",
    "A numbered name comes from an accidental duplicate, and says nothing about the object.",
    "Rename the collection, or remove it if it is a leftover.",
    _numbered_names,
    _needs_tags,
)
C6 = Rule(
    "C6",
    "ground",
    "hard",
    "There is a system named ground with at least one object in it.",
    "Everything else must, directly or through others, stand on the ground.",
    "Make a collection named ground with protocol_role='system', and link the floor, table or terrain into it.",
    _missing_ground,
)
RULES = (C1, C2, C3, C4, C5, C6)
