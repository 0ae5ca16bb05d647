# SPDX-License-Identifier: GPL-3.0-or-later
"""Real defaults where RNA's are wrong, and settings that a readout leaves out.

Nearly all defaults of RNA are right. The others are here as a new modifier, constraint or effector has them; ``*FLOAT``
is for all numbers of a struct, a name with a colon for one variant of it.
"""

_IDENTITY = tuple(tuple(1.0 if row == column else 0.0 for column in range(4)) for row in range(4))
_FIRST_OF_20 = (True,) + (False,) * 19

DEFAULTS = {
    "EffectorWeights": {"*FLOAT": 1.0},
    "CollisionSettings": {
        "use": True,
        "thickness_inner": 0.2,
        "thickness_outer": 0.02,
        "damping": 0.1,
        "cloth_friction": 5.0,
        "use_culling": True,
    },
    "ClothCollisionSettings": {"damping": 0.0},
    "SoftBodySettings": {
        "friction": 0.5,
        "mass": 1.0,
        "gravity": 9.8,
        "speed": 1.0,
        "goal_max": 1.0,
        "goal_default": 0.7,
        "goal_spring": 0.5,
        "pull": 0.5,
        "push": 0.5,
        "damping": 0.5,
        "shear": 1.0,
        "collision_type": "AVERAGE",
        "ball_size": 0.49,
        "ball_stiff": 1.0,
        "ball_damp": 0.5,
        "error_threshold": 0.1,
        "step_min": 10,
        "step_max": 300,
        "choke": 3,
        "fuzzy": 1,
        "use_auto_step": True,
        "use_goal": True,
        "use_edges": True,
    },
    "FieldSettings": {
        "strength": 1.0,
        "linear_drag": 1.0,
        "harmonic_damping": 1.0,
        "quadratic_drag": 1.0,
        "apply_to_location": True,
        "apply_to_rotation": True,
        "guide_minimum": 1.0,
    },
    "FieldSettings:TEXTURE": {"size": 1.0},
    "FieldSettings:VORTEX": {"shape": "PLANE"},
    "FieldSettings:WIND": {"shape": "PLANE", "flow": 1.0, "wind_factor": 1.0},
    "ParticleSettings": {
        "material_slot": "Default Material",
        "timestep": 0.04,
        "hair_length": 4.0,
        "line_length_tail": 0.5,
    },
    "RigidBodyObject": {
        "mesh_source": "DEFORM",
        "use_deactivation": False,
        "collision_collections": _FIRST_OF_20,
    },
    "RigidBodyConstraint": {"spring_type": "SPRING2", "enabled": True, "disable_collisions": True},
    "FluidDomainSettings": {
        "cache_mesh_format": "BOBJECT",
        "openvdb_data_depth": "16",
        "color_ramp_field": "DENSITY",
    },
    "FluidDomainSettings:LIQUID": {
        **{
            f"use_collision_border_{side}": True
            for side in ("front", "back", "right", "left", "top", "bottom")
        },
        "use_flip_particles": True,
        "color_ramp_field": "PHI",
    },
    "FluidFlowSettings": {"flow_source": "MESH"},
    "FluidFlowSettings:LIQUID": {"surface_distance": 0.0},
    "DataTransferModifier": {"mix_factor": 1.0},
    "MeshSequenceCacheModifier": {"use_vertex_interpolation": False},
    "NormalEditModifier": {"use_direction_parallel": False},
    "VertexWeightProximityModifier": {"proximity_mode": "OBJECT", "proximity_geometry": {"VERTEX"}},
    "BevelModifier": {"edge_weight": "bevel_weight_edge", "vertex_weight": "bevel_weight_vert"},
    "MirrorModifier": {"use_axis": (True, False, False)},
    "VolumeToMeshModifier": {
        "threshold": 0.1,
        "grid_name": "density",
        "voxel_size": 0.1,
        "voxel_amount": 32,
    },
    "Constraint": {"influence": 1.0},
    "CopyLocationConstraint": {"use_x": True, "use_y": True, "use_z": True},
    "CopyRotationConstraint": {"use_x": True, "use_y": True, "use_z": True},
    "CopyScaleConstraint": {"use_x": True, "use_y": True, "use_z": True, "use_add": False},
    "MaintainVolumeConstraint": {"free_axis": "SAMEVOL_Y", "volume": 1.0},
    "TransformConstraint": {
        "map_to_y_from": "Y",
        "map_to_z_from": "Z",
        **{
            f"{way}_{end}_{axis}_scale": 1.0
            for way in ("from", "to")
            for end in ("min", "max")
            for axis in "xyz"
        },
    },
    "DampedTrackConstraint": {"track_axis": "TRACK_Y"},
    "KinematicConstraint": {
        "iterations": 500,
        "weight": 1.0,
        "orient_weight": 1.0,
        "use_tail": True,
        "use_location": True,
        "use_stretch": True,
        "distance": 1.0,
    },
    "LockedTrackConstraint": {"track_axis": "TRACK_Y", "lock_axis": "LOCK_Z"},
    "SplineIKConstraint": {
        "chain_count": 1,
        "y_scale_mode": "FIT_CURVE",
        "use_original_scale": True,
        "bulge": 1.0,
        "bulge_min": 1.0,
        "bulge_max": 1.0,
    },
    "StretchToConstraint": {"keep_axis": "SWING_Y", "bulge": 1.0, "bulge_min": 1.0, "bulge_max": 1.0},
    "TrackToConstraint": {"track_axis": "TRACK_NEGATIVE_Z", "up_axis": "UP_Y"},
    "ActionConstraint": {"mix_mode": "AFTER", "transform_channel": "LOCATION_X"},
    "ChildOfConstraint": {
        **{f"use_{what}_{axis}": True for what in ("location", "rotation", "scale") for axis in "xyz"},
        "inverse_matrix": _IDENTITY,
    },
    "FloorConstraint": {"floor_location": "FLOOR_Z"},
    "FollowPathConstraint": {"forward_axis": "FORWARD_Y", "up_axis": "UP_Z"},
    "GeometryAttributeConstraint": {
        "attribute_name": "position",
        "mix_loc": True,
        "mix_rot": True,
        "mix_scl": True,
    },
    "ShrinkwrapConstraint": {"project_axis": "POS_Z", "project_axis_space": "LOCAL"},
    "CameraSolverConstraint": {"use_active_clip": True},
    "FollowTrackConstraint": {"use_active_clip": True},
    "ObjectSolverConstraint": {"use_active_clip": True},
    "RenderSettings": {
        "simplify_subdivision_render": 6,
        "simplify_child_particles_render": 1.0,
    },
    "ImageFormatSettings": {"exr_codec": "ZIP"},
    "ShaderNodeBsdfPrincipled": {"distribution": "MULTI_GGX", "subsurface_method": "RANDOM_WALK"},
    "SceneEEVEE": {"use_fast_gi": True},
    "CyclesRenderSettings": {"denoiser": "OPENIMAGEDENOISE", "sampling_pattern": "TABULATED_SOBOL"},
    "ColorManagedViewSettings": {"look": "None", "view_transform": "AgX"},
}

LEFT_OUT = {
    # Listed elsewhere, or of the user interface.
    "*": (
        *("rna_type", "name", "type", "show_expanded", "show_on_cage", "show_in_editmode"),
        *("is_active", "active"),
        *("show_viewport", "show_render", "use_pin_to_last", "use_apply_on_spline"),
        *("select", "use_fake_user"),
        *("parent", "original", "asset_data", "preview", "tag"),
    ),
    # Set by Blender itself, at random or from the settings of the user.
    "OceanModifier": ("filepath",),
    "HookModifier": ("vertex_indices",),
    "FieldSettings": ("seed",),
    "Material": ("blend_method",),
    "BevelModifier": ("width_pct",),
    "ShaderNodeOutputMaterial": ("is_active_output",),
    "ShaderNodeOutputWorld": ("is_active_output",),
    "RenderSettings": ("filepath", "threads", "threads_mode", "use_stamp_memory"),
    "NodesModifier": (
        *("show_group_selector", "show_manage_panel", "open_output_attributes_panel", "open_manage_panel"),
        *("open_bake_panel", "open_named_attributes_panel"),
        *("open_bake_data_blocks_panel", "open_warnings_panel"),
        "node_group",
    ),
    "Constraint": ("owner_space_matrix", "set_inverse_pending", "enabled"),
    "SplineIKConstraint": ("joint_bindings",),
    "ColorManagedViewSettings": (
        "white_balance_temperature",
        "white_balance_tint",
        "white_balance_whitepoint",
    ),
    # Listed by name or with the cache; reading the two formats prints warnings.
    "FluidDomainSettings": (
        *(f"has_cache_baked_{part}" for part in ("any", "data", "noise", "mesh", "particles", "guide")),
        *(f"cache_frame_pause_{part}" for part in ("data", "noise", "mesh", "particles", "guide")),
        *("domain_type", "resolution_max", "cache_type", "cache_directory"),
        *("cache_frame_start", "cache_frame_end"),
        *("cache_particle_format", "openvdb_cache_compress_type", "vector_scale_with_magnitude"),
        *("show_gridlines", "show_velocity", "vector_display_type", "use_slice", "display_interpolation"),
    ),
    "CyclesRenderSettings": ("preview_denoiser",),
    "ParticleSettings": ("count", "frame_start", "frame_end", "lifetime"),
    "RigidBodyObject": ("collision_shape", "mass", "kinematic"),
}
