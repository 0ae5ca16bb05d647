# SPDX-License-Identifier: GPL-3.0-or-later
"""The custom properties that the scene protocol writes on scenes, collections and objects."""

ROLE, ROOT, CONTACT = "protocol_role", "is_object_root", "contact_with"
ONLY_ON_OBJECTS = ("deformation_kind", "motion_kind", "allows_disconnected")
STRICT_GROUNDING = "strict_grounding"
TAGS = (ROLE, ROOT, CONTACT, *ONLY_ON_OBJECTS, STRICT_GROUNDING)
SYSTEM, OBJECT = "system", "object"  # values of ROLE
GROUND = "ground"  # the name of the system that everything stands on


def object_collections(scene):
    """The collections of a scene that are tagged as objects (L3 of the protocol)."""
    return [child for child in scene.collection.children_recursive if child.get(ROLE) == OBJECT]
