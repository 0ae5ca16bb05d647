# SPDX-License-Identifier: GPL-3.0-or-later
"""Which properties of a data-block are its content, and which part of it each belongs to."""

import bpy

CUSTOM, CACHES = "custom properties", "caches"
_REST = "settings"


def _words(text):
    return frozenset(text.split())


# User interface settings, values that Blender derives from others, and what other properties cover.
_NEVER = _words(
    """rna_type original preview asset_data library override_library library_weak_reference session_uid tag
    use_fake_user use_extra_user is_runtime_data depsgraph particles child_particles edit_bones selection_sets exporters
    texture_paint_images texture_paint_slots motion_path animation_visualization node_warnings
    matrix matrix_world matrix_basis matrix_local is_valid solver_result execution_time frame_current
    select select_control_point select_left_handle select_right_handle select_head select_tail
    wireframe_color_type hide_select show_expanded show_in_editmode color_tag grids pixels
    cache_frame_pause_data cache_frame_pause_noise cache_frame_pause_mesh cache_frame_pause_particles
    cache_frame_pause_guide"""
)
_NEVER_OF = {
    "Scene": _words(
        """frame_subframe frame_float show_subframe time_jump_unit time_jump_delta lock_frame_selection_to_range
        show_keys_from_selected_only tool_settings cursor keying_sets keying_sets_all transform_orientation_slots
        safe_areas annotation active_clip uvedit objects"""
    ),
    "RenderSettings": _words("filepath bake use_lock_interface threads threads_mode use_persistent_data"),
    "ImageFormatSettings": _words("linear_colorspace_settings"),
    "ViewLayer": _words("objects"),
    "Collection": _words("all_objects"),
    "Key": _words("user"),
    "ShapeKey": _words("points"),
    "Node": _words(
        """location location_absolute width height hide color use_custom_color internal_links
        warning_propagation"""
    ),
    "NodeSocket": _words("enabled"),  # by the node's mode, at latest when the file is read again
    "NodesModifierPanel": _words("is_open"),
    "BoneCollection": _words("is_expanded"),
    "FCurve": _words("hide lock"),
    "Object": _words("dimensions"),
    "Camera": _words("angle angle_x angle_y"),
    # Reading these prints warnings; other settings say which files there are.
    "FluidDomainSettings": _words("cache_particle_format openvdb_cache_compress_type"),
    "Image": _words("render_slots filepath filepath_raw packed_file packed_files"),
    "Sound": _words("packed_file"),
    "VectorFont": _words("packed_file"),
    "Volume": _words("packed_file"),
    "Text": _words(
        """current_character current_line current_line_index select_end_line select_end_line_index
        select_end_character filepath"""
    ),
}
# What renders of a frame do not depend on.
_NEVER_OF_PICTURES = {
    "Scene": _words(
        """frame_start frame_end frame_step frame_preview_start frame_preview_end use_preview_range
        sequence_editor"""
    ),
    "RenderSettings": _words("image_settings ffmpeg use_overwrite use_placeholder use_file_extension"),
}
_ONLY_OF = {"Mesh": ("materials", "attributes", "animation_data", "shape_keys", "cycles")}
# Read-only, and still the data-block's own.
_ALSO = _words("is_baked domain is_output use_connect handle")
_ALSO_OF = {
    "Bone": ("head_local", "tail_local", "matrix_local"),
    "LayerCollection": ("name",),
    "FluidDomainSettings": (
        "has_cache_baked_data",
        "has_cache_baked_mesh",
        "has_cache_baked_noise",
        "has_cache_baked_particles",
        "has_cache_baked_guide",
    ),
}
_CACHE_SETTINGS = ("has_cache_", "cache_frame_")

# Names of one and the same value.
_ALIASES = {
    "ClothSettings": ("pin_stiffness goal_spring",),
    "FieldSettings": (
        "strength linear_drag guide_minimum",
        "harmonic_damping quadratic_drag",
        "flow inflow",
        "size rest_length",
    ),
    "ParticleSettings": ("timestep time_tweak", "normal_factor hair_length"),
}
_ALIASES_BY_PROPERTY = {
    (kind, name): tuple(names.split())
    for kind, groups in _ALIASES.items()
    for names in groups
    for name in names.split()
}

_PARTS = {
    "animation_data": "animation",
    "node_tree": "nodes",
    "materials": "materials",
    "shape_keys": "shape keys",
}
_PARTS_OF = {
    "Object": {
        "transform": """location rotation_quaternion rotation_axis_angle rotation_euler rotation_mode scale
            delta_location delta_rotation_euler delta_rotation_quaternion delta_scale""",
        "parent": """parent parent_type parent_vertices parent_bone use_parent_final_indices matrix_parent_inverse
            track_axis up_axis use_camera_lock_parent""",
        "data": "data type",
        "materials": "material_slots",
        "modifiers": "modifiers shader_effects particle_systems",
        "constraints": "constraints",
        "pose": "pose",
        "physics": "field collision soft_body rigid_body rigid_body_constraint use_simulation_cache",
        "vertex groups": "vertex_groups",
        "visibility": """hide_viewport hide_render hide_probe_volume hide_probe_sphere hide_probe_plane
            hide_surface_pick visible_camera visible_diffuse visible_glossy visible_transmission
            visible_volume_scatter visible_shadow is_holdout is_shadow_catcher light_linking lightgroup""",
        "instancing": """show_instancer_for_render show_instancer_for_viewport instance_type
            use_instance_vertices_rotation use_instance_faces_scale instance_faces_scale instance_collection""",
    },
    "Scene": {
        "collection": "collection",
        "camera": "camera",
        "world": "world",
        "physics": "rigidbody_world",
        "gravity": "gravity use_gravity",
        "frame range": """frame_start frame_end frame_step frame_preview_start frame_preview_end use_preview_range
            use_custom_simulation_range simulation_frame_start simulation_frame_end""",
        "render": "render cycles cycles_curves eevee display hydra grease_pencil_settings use_nodes",
        "color management": "display_settings view_settings sequencer_colorspace_settings",
        "compositing": "compositing_node_group",
        "view layers": "view_layers",
        "markers": "timeline_markers",
        "sequencer": "sequence_editor",
    },
    "Collection": {
        "objects": "objects collection_objects",
        "children": "children collection_children",
        "visibility": "hide_viewport hide_render",
    },
    "ParticleSettings": {"texture": "texture_slots"},
}
_PARTS_BY_PROPERTY = {
    kind: {name: part for part, names in parts.items() for name in names.split()}
    for kind, parts in _PARTS_OF.items()
}
_REST_OF = {
    "Mesh": "geometry",
    "Action": "keyframes",
    "Key": "shapes",
    "Text": "text",
    "Image": "picture",
    "NodeTree": "nodes",
    "Armature": "bones",
}


def rest_of(block):
    """The part for properties that belong to no other part."""
    return next((part for kind in _rna_lineage(block) if (part := _REST_OF.get(kind.identifier))), _REST)


def part_of(block, name):
    """The part that a property belongs to."""
    for kind in _rna_lineage(block):
        if part := _PARTS_BY_PROPERTY.get(kind.identifier, {}).get(name):
            return part
    return _PARTS.get(name) or rest_of(block)


def extra_parts_of(block):
    """{part: content that no property of the data-block holds}."""
    if block.bl_rna.identifier != "Object":
        return {}
    parts = {}
    if len(block.vertex_groups):
        vertices = getattr(block.data, "vertices", ())
        parts["weights"] = [(group.group, group.weight) for vertex in vertices for group in vertex.groups]
    if hidden := _hidden(block):
        parts["visibility in view layers"] = hidden
    return parts


def _hidden(obj):
    """The view layers in which the eye in the outliner hides it."""
    return [
        (scene.name, layer.name)
        for scene in bpy.data.scenes
        for layer in scene.view_layers
        if obj.hide_get(view_layer=layer)
    ]


def names_of(struct, name):
    """The names under which Blender has a property of ``struct``: mostly one."""
    return _ALIASES_BY_PROPERTY.get((struct.bl_rna.identifier, name), (name,))


def reading_plan_of(struct, *, pictures):
    """How to read each property: (name, VALUE | ARRAY | FLAGS | PATH | POINTER | COLLECTION, is part of a cache)."""
    never, also, only = set(_NEVER), set(_ALSO), None
    for kind in _rna_lineage(struct):
        never |= _NEVER_OF.get(kind.identifier, set())
        if pictures:
            never |= _NEVER_OF_PICTURES.get(kind.identifier, set())
        also |= set(_ALSO_OF.get(kind.identifier, ()))
        only = only or _ONLY_OF.get(kind.identifier)
    plan = []
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name not in also and (name in never or name.startswith("active") or (only and name not in only)):
            continue
        how = _access(prop, name in also)
        if how is not None:
            plan.append((name, how, _is_cache(struct, prop)))
    return plan


def _access(prop, wanted):
    if prop.type in {"POINTER", "COLLECTION"} and not wanted:
        return prop.type
    if prop.is_readonly and not wanted:
        return None
    if prop.type == "STRING" and prop.subtype == "FILE_PATH":
        return "PATH"
    if prop.type == "STRING" and prop.subtype == "DIR_PATH":
        return None  # where caches lie, which changes with the file's own place
    if prop.type == "ENUM" and prop.is_enum_flag:
        return "FLAGS"
    return "ARRAY" if getattr(prop, "is_array", False) else "VALUE"


def _is_cache(struct, prop):
    """Whether a bake sets it, rather than the user."""
    if prop.type == "POINTER":
        return prop.fixed_type.identifier == "PointCache"
    return struct.bl_rna.identifier == "FluidDomainSettings" and prop.identifier.startswith(_CACHE_SETTINGS)


def _rna_lineage(struct):
    """Its RNA type and the types that this one inherits from."""
    kind = struct.bl_rna
    while kind is not None:
        yield kind
        kind = kind.base
