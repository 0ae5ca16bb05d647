"""C1 to C6: the layout of the collections (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from agents.protocol.rule import Idle, Rule, Subject
from agents.protocol.structure import SCENE
from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures

_NUMBERED = re.compile(r"\.\d{3,}$")


def _every_object_in_a_system(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    for thing in structure.things:
        if not structure.systems_of(thing.collection):
            yield C1.finding((thing.name,), f"The object {thing.name!r} is in no system.")


def _systems_at_the_root(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    for system in subject.structure.systems:
        if SCENE not in system.parents:
            where = f"in {', '.join(map(repr, system.parents))}" if system.parents else "in no scene"
            yield C2.finding(
                (system.name,), f"The system {system.name!r} is {where}, not directly in the scene."
            )


def _one_object_per_mesh(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    for mesh in structure.meshes:
        owners = structure.owners.get(mesh.name, ())
        if not owners:
            yield C3.finding((mesh.name,), f"The mesh {mesh.name!r} is in no object.", measured=0.0)
        elif len(owners) > 1:
            names = ", ".join(repr(owner.name) for owner in owners)
            yield C3.finding(
                (mesh.name,),
                f"The mesh {mesh.name!r} is in {len(owners)} objects: {names}.",
                measured=float(len(owners)),
            )


def _one_root_per_object(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    for thing in subject.structure.things:
        roots = [one for one in thing.roots if one.type == "EMPTY"]
        wrong = [one.name for one in thing.roots if one.type != "EMPTY"]
        if len(roots) != 1 or wrong:
            named = f" ({', '.join(one.name for one in roots)})" if len(roots) > 1 else ""
            also = f"; {', '.join(map(repr, wrong))} is tagged as root but is no Empty" if wrong else ""
            yield C4.finding(
                (thing.name, *(one.name for one in thing.roots)),
                f"The object {thing.name!r} has {len(roots)} root Empties{named}{also}.",
                measured=float(len(roots)),
            )


def _named_by_somebody(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    for one in subject.facts.collections:
        if one.role and _NUMBERED.search(one.name):
            yield C5.finding(
                (one.name,), f"The collection {one.name!r} has the number of a duplicate as its name."
            )


def _has_a_ground(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    structure = subject.structure
    system = structure.collections.get(GROUND)
    if system is None or system.role != "system":
        yield C6.finding((GROUND,), "There is no system called 'ground'.", measured=0.0)
    elif not structure.grounds:
        yield C6.finding((GROUND,), "The system 'ground' holds no object.", measured=0.0)


def _only_with_tags(subject: Subject) -> tuple[()]:
    if not any(one.role for one in subject.facts.collections):
        raise Idle("no collection carries a role of the protocol")
    return ()


def _only_with_objects(subject: Subject) -> tuple[()]:
    if not subject.structure.things:
        _only_with_tags(subject)
        raise Idle("no collection is an object of the protocol")
    return ()


def _only_with_systems(subject: Subject) -> tuple[()]:
    if not subject.structure.systems:
        _only_with_tags(subject)
        raise Idle("no collection is a system of the protocol")
    return ()


def _only_with_meshes(subject: Subject) -> tuple[()]:
    if not subject.structure.meshes:
        raise Idle("the scene has no mesh")
    return ()


C1 = Rule(
    "C1",
    "object in a system",
    "hard",
    "Every object (L3) is in at least one system (L2).",
    "An object outside every system is not reached when the scene is checked, shown or changed by system.",
    "Link the object's collection into a system's collection.",
    _every_object_in_a_system,
    _only_with_objects,
)
C2 = Rule(
    "C2",
    "system at the root",
    "hard",
    "Every system (L2) is directly under the scene's own collection.",
    "Nested systems make it ambiguous whose an object is.",
    "Link the collection into the scene's collection and unlink it from the others.",
    _systems_at_the_root,
    _only_with_systems,
)
C3 = Rule(
    "C3",
    "mesh in one object",
    "hard",
    "Every mesh is in exactly one object (L3).",
    "A mesh of no object is checked by nobody; one of two objects moves with neither.",
    "Link the mesh into the collection of the object that it is a part of, and only there.",
    _one_object_per_mesh,
    _only_with_meshes,
)
C4 = Rule(
    "C4",
    "one root",
    "hard",
    "Every object (L3) has exactly one Empty tagged is_object_root.",
    "Without one root the object has no handle: it cannot be placed or moved as a whole.",
    "Keep one Empty with is_object_root, in the object's collection, and untag or remove the others.",
    _one_root_per_object,
    _only_with_objects,
)
C5 = Rule(
    "C5",
    "names of their own",
    "hard",
    "No collection of the protocol has a name such as Chair.001.",
    "A numbered name comes from something made twice by accident, and says nothing.",
    "Give the collection a name of its own, or remove it if it is left over.",
    _named_by_somebody,
    _only_with_tags,
)
C6 = Rule(
    "C6",
    "a ground",
    "hard",
    "There is a system called ground with at least one object in it.",
    "Everything else is to stand on something in the end.",
    "Make a collection ground with protocol_role='system', and put the floor's (or table's, terrain's) object into it.",
    _has_a_ground,
)
RULES = (C1, C2, C3, C4, C5, C6)
