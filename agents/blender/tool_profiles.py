"""Which tools a client is offered: profiles, each with all that the one before it has."""

from __future__ import annotations

from typing import Literal, get_args

Profile = Literal["docs", "look", "build", "all"]
PROFILES: tuple[Profile, ...] = get_args(Profile)
DEFAULT: Profile = "build"

# The first profile that has a tool; of one that does not stand here, it is build.
_FIRST: dict[str, Profile] = {
    "blender_docs": "docs",
    "blender_check": "docs",
    "blender_scene_state": "look",
    "blender_single_mesh_preview": "look",
    "blender_object_preview": "look",
    "blender_system_layout_preview": "look",
    "blender_scene_layout_preview": "look",
    "blender_material_preview": "look",
    "blender_uv_preview": "look",
    "blender_motion_sheet_preview": "look",
    "blender_verify": "look",
    "blender_load": "look",
    "blender_import": "all",
    "blender_export": "all",
    "blender_tag_object": "all",  # blender_group sets the tags of objects too, in fewer calls
}


def first_profile(tool: str) -> Profile:
    """The smallest profile that has the tool of that name."""
    return _FIRST.get(tool, "build")


def is_offered(tool: str, profile: Profile) -> bool:
    """Whether a profile has the tool of that name."""
    return PROFILES.index(first_profile(tool)) <= PROFILES.index(profile)
