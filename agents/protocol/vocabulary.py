"""The vocabulary of the scene protocol: its levels, its custom properties, their values, and what these mean.

The protocol has three levels of collections. L1 is the scene. An L2 is a *system*: a collection directly under the
scene's root that groups objects or holds lights and cameras. An L3 is an *object*: a collection below a system with
all meshes of one logical object and one Empty, its root, to which each mesh's chain of parents leads. Collections
without a role are outside the protocol.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

Owner = Literal["collection", "object", "scene"]
Role = Literal["system", "object"]
DeformationKind = Literal["rig", "sim_cloth", "sim_fluid", "sim_rigid", "sim_soft", "sim_particle", "none"]
MotionKind = Literal["keyframe", "bake", "none"]

PROTOCOL_ROLE = "protocol_role"
IS_OBJECT_ROOT = "is_object_root"
CONTACT_WITH = "contact_with"
DEFORMATION_KIND = "deformation_kind"
MOTION_KIND = "motion_kind"
ALLOWS_DISCONNECTED = "allows_disconnected"
STRICT_GROUNDING = "strict_grounding"

GROUND = "ground"


@dataclass(frozen=True, slots=True)
class CustomProperty:
    """A custom property of the protocol: its owner, and its meaning there.

    ``on_role``: the role that the collection must have; None for any.
    """

    name: str
    owner: Owner
    meaning: str
    on_role: Role | None = None


ROLES: dict[Role, str] = {
    "system": "An L2: a collection directly under the scene's root that groups objects or holds lights or cameras.",
    "object": "An L3: a collection in a system, with all meshes of one logical object and one root Empty.",
}

DEFORMATION_KINDS: dict[DeformationKind, str] = {
    "rig": "An armature, a lattice, shape keys or another deformer deforms it, or a bone carries it.",
    "sim_cloth": "The cloth solver moves it.",
    "sim_fluid": "The fluid solver makes or moves it: liquid, smoke or fire.",
    "sim_rigid": "The rigid-body solver moves it.",
    "sim_soft": "The soft-body solver moves it.",
    "sim_particle": "It consists of particles.",
    "none": "Nothing deforms it, and no solver moves it.",
}

MOTION_KINDS: dict[MotionKind, str] = {
    "keyframe": "Keyframes move it, or an object that it follows.",
    "bake": "Its motion is a baked simulation.",
    "none": "It does not move.",
}

SYSTEMS: dict[str, str] = {
    GROUND: "What everything else stands on; required, with at least one object in it.",
    "lighting": "The lights.",
    "cameras": "The cameras.",
    "physics": "Force fields and other invisible helpers of the solvers.",
}

PROPERTIES: tuple[CustomProperty, ...] = (
    CustomProperty(PROTOCOL_ROLE, "collection", "Whether the collection is a system (L2) or an object (L3)."),
    CustomProperty(
        DEFORMATION_KIND,
        "collection",
        "The mechanism that deforms or simulates the object; without it, the rules about it do not run.",
        "object",
    ),
    CustomProperty(
        MOTION_KIND,
        "collection",
        "How the object moves; without it, the rules about it do not run.",
        "object",
    ),
    CustomProperty(
        ALLOWS_DISCONNECTED, "collection", "The object's meshes need not touch each other.", "object"
    ),
    CustomProperty(
        IS_OBJECT_ROOT,
        "object",
        "This Empty is the root of its object (L3): it places and moves the whole object.",
    ),
    CustomProperty(
        CONTACT_WITH,
        "object",
        "Names of the meshes or roots that this mesh, or this root's object, touches. One side is enough. A root that "
        "names itself lets its object's own parts reach into each other.",
    ),
    CustomProperty(
        STRICT_GROUNDING,
        "scene",
        "An object that is not connected to the ground fails the check (rule W1 becomes hard).",
    ),
)


def meaning_of(name: str, choices: dict[Any, str] | None = None) -> str:
    """The meaning of a property and of each of its ``choices``, in one line."""
    meaning = next(tag.meaning for tag in PROPERTIES if tag.name == name)
    return " ".join([meaning, *(f"{choice}: {text}" for choice, text in (choices or {}).items())])
