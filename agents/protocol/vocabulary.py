"""The words of the scene protocol: which custom properties carry it, what they may say, and what that means.

Three levels, of Blender's own collections. L1 is the scene. An L2 is a *system*: a collection directly under the
scene's root that groups objects or holds lights and cameras. An L3 is an *object*: a collection below a system with
all meshes of one logical object and one Empty, its root, to which each mesh's chain of parents leads. A collection
without a role is outside the protocol.
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
class Property:
    """A custom property of the protocol: what carries it, and what it says there.

    ``on_role``: the role that a collection must have to carry it; None where any may.
    """

    name: str
    owner: Owner
    meaning: str
    on_role: Role | None = None


ROLES: dict[Role, str] = {
    "system": "An L2: a collection directly under the scene's root that groups objects, or holds lights or cameras.",
    "object": "An L3: a collection in a system, with all meshes of one logical object and one root Empty.",
}

DEFORMATION_KINDS: dict[DeformationKind, str] = {
    "rig": "An armature, a lattice, shape keys or another deformer bends it.",
    "sim_cloth": "The cloth solver moves it.",
    "sim_fluid": "The fluid solver makes or moves it: liquid, smoke or fire.",
    "sim_rigid": "The rigid-body solver moves it.",
    "sim_soft": "The soft-body solver moves it.",
    "sim_particle": "A particle system makes it up.",
    "none": "Nothing deforms it, and no solver moves it.",
}

MOTION_KINDS: dict[MotionKind, str] = {
    "keyframe": "Keyframes move it, on itself or on what it follows.",
    "bake": "Its motion is a baked simulation.",
    "none": "It stays where it is.",
}

SYSTEMS: dict[str, str] = {
    GROUND: "What everything else stands on; it must be there, with at least one object in it.",
    "lighting": "The lights.",
    "cameras": "The cameras.",
    "physics": "Force fields, and what else the solvers need that is not to be seen.",
}

PROPERTIES: tuple[Property, ...] = (
    Property(PROTOCOL_ROLE, "collection", "Whether the collection is a system (L2) or an object (L3)."),
    Property(
        DEFORMATION_KIND,
        "collection",
        "Which mechanism shapes the object; undeclared, the rules about it do not run.",
        "object",
    ),
    Property(
        MOTION_KIND,
        "collection",
        "How the object comes to move; undeclared, the rules about it do not run.",
        "object",
    ),
    Property(ALLOWS_DISCONNECTED, "collection", "The object's meshes need not touch one another.", "object"),
    Property(IS_OBJECT_ROOT, "object", "This Empty is the root of its object (L3): its anchor and handle."),
    Property(
        CONTACT_WITH,
        "object",
        "Names of the meshes or roots that this mesh, or the object of this root, touches. One side suffices.",
    ),
    Property(STRICT_GROUNDING, "scene", "An object that nothing connects to the ground fails the check."),
)


def meaning_of(name: str, choices: dict[Any, str] | None = None) -> str:
    """What a property says, and what each of its ``choices`` means, for whoever is to set it."""
    told = next(one.meaning for one in PROPERTIES if one.name == name)
    return " ".join([told, *(f"{choice}: {meaning}" for choice, meaning in (choices or {}).items())])
