"""Messages of animation that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

ANIMATION = (
    NamelessMessage(
        ("locked or sampled",),
        (f"{T}FCurve.lock", f"{T}FCurve.modifiers", f"{T}FCurve.convert_to_keyframes"),
        "The F-curve takes no keys: `fcurve.lock = False` unlocks it, `fcurve.convert_to_keyframes(start, end)` "
        "makes keys of samples, and a modifier of it may stand in the way.",
    ),
    NamelessMessage(
        ('attribute "id_type" from "DriverTarget" is read-only',),
        (f"{T}DriverTarget.id_type", f"{T}DriverVariable.type"),
        "A variable of transforms, of a distance or of a rotation takes objects alone: leave `id_type` out, and set "
        "`id`. To read from other data, set `variable.type = 'SINGLE_PROP'` first.",
    ),
    NamelessMessage(
        ("Follow Path constraint not found",),
        ("bpy.ops.constraint.followpath_path_animate", f"{T}FollowPathConstraint"),
        "The operator looks for a constraint of that name on the active object: "
        "`with bpy.context.temp_override(active_object=obj, object=obj): "
        "bpy.ops.constraint.followpath_path_animate(constraint=con.name)`.",
    ),
    NamelessMessage(
        ("Could not find constraint data for Child-Of",),
        ("bpy.ops.constraint.childof_set_inverse", f"{T}ChildOfConstraint.inverse_matrix"),
        "The operator looks for a constraint of that name on the active object, with `owner='BONE'` on the active pose "
        "bone: `with bpy.context.temp_override(active_object=rig, object=rig, active_pose_bone=bone): "
        "bpy.ops.constraint.childof_set_inverse(constraint=con.name, owner='BONE')`.",
    ),
    NamelessMessage(
        ("A layer may not have more than one strip",),
        (f"{T}ActionLayer.strips", f"{T}ActionStrips.new"),
        "The layer has its strip already: take `layer.strips[0]`.",
    ),
    NamelessMessage(
        ("An Action may not have more than one layer",),
        (f"{T}Action.layers", f"{T}ActionLayers.new"),
        "The action has its layer already: take `action.layers[0]`.",
    ),
    NamelessMessage(
        ("UnicodeDecodeError", "codec can't decode byte"),
        (f"{T}EditBone.name", f"{T}ArmatureEditBones"),
        "Where no file is read, it is a name of what was freed: of an edit bone after Edit Mode was left, or after "
        "undo. Keep the name (`name = bone.name`) before, and look it up again.",
    ),
    NamelessMessage(
        ("No active pose bone to add a constraint to",),
        ("bpy.ops.pose.constraint_add", f"{T}ArmatureBones.active"),
        'Make a bone active before: `armature.bones.active = armature.bones["Bone"]`. A script needs no active bone: '
        "`obj.pose.bones[\"Bone\"].constraints.new('IK')`.",
    ),
    NamelessMessage(
        ("the track does not have any space to accommodate this new strip",),
        (f"{T}NlaStrips.new", f"{T}NlaTracks.new"),
        "The track has a strip in these frames: give another `start`, or add it to a new track "
        "(`animation_data.nla_tracks.new()`).",
    ),
    NamelessMessage(
        ("keyframe_insert() property", "not found"),
        (f"{T}bpy_struct.keyframe_insert",),
        'The path is a property of the very thing, as text: `obj.keyframe_insert("location")`; what belongs to its '
        "data is keyed there (`obj.data.keyframe_insert(…)`).",
    ),
    NamelessMessage(
        ('Assign action "', "before calling this function"),
        (f"{T}Action.fcurve_ensure_for_datablock", f"{T}AnimData.action"),
        "The object must have the action: `obj.animation_data_create().action = action`.",
    ),
    NamelessMessage(
        ("Cannot set slot without an assigned Action",),
        (f"{T}AnimData.action", f"{T}AnimData.action_slot"),
        "Assign the action first: `obj.animation_data.action = action`, then the slot.",
    ),
    NamelessMessage(
        ("This slot (", "is not suitable for this data-block type"),
        (f"{T}AnimData.action_suitable_slots", f"{T}ActionSlots.new"),
        "A slot is for one type of data-block, its `target_id_type`: take one of the "
        "`animation_data.action_suitable_slots`, or make one: `action.slots.new(obj.id_type, obj.name)`.",
    ),
    NamelessMessage(
        ("'list' object has no attribute 'driver'",),
        (f"{T}bpy_struct.driver_add", f"{T}FCurve.driver"),
        "Of a property with several numbers `driver_add` returns a list, an F-curve each, unless an index is given: "
        '`obj.driver_add("location", 0).driver`.',
    ),
    NamelessMessage(
        ("keyframe_insert() path includes index",),
        (f"{T}bpy_struct.keyframe_insert",),
        'One number of several is keyed by its index: `obj.keyframe_insert("location", index=0)`.',
    ),
    NamelessMessage(
        ("keyframe_delete() path includes index",),
        (f"{T}bpy_struct.keyframe_delete",),
        'The key of one number of several goes by its index: `obj.keyframe_delete("location", index=0)`.',
    ),
    NamelessMessage(
        ("driver_add(): path includes index",),
        (f"{T}bpy_struct.driver_add",),
        'One number of several is driven by its index, given by place: `obj.driver_add("location", 0)`.',
    ),
    NamelessMessage(
        ("driver_remove(): path includes index",),
        (f"{T}bpy_struct.driver_remove",),
        'The driver of one number of several goes by its index: `obj.driver_remove("location", 0)`.',
    ),
    NamelessMessage(
        ("keyframe_insert()() takes at most 1 positional argument",),
        (f"{T}bpy_struct.keyframe_insert",),
        'All but the path is given by name: `obj.keyframe_insert("location", frame=10)`.',
    ),
    NamelessMessage(
        ("driver_add(): property", "not found"),
        (f"{T}bpy_struct.driver_add",),
        'The path is a property of the very thing, as text: `obj.driver_add("location", 0)`; what belongs to its '
        "data is driven there (`obj.data.driver_add(…)`).",
    ),
    NamelessMessage(
        ("Dependency cycle detected",),
        (
            f"{T}Object.constraints",
            "animation/drivers/troubleshooting",
            f"{T}Object.parent",
            f"{T}AnimData.drivers",
        ),
        "Each of the things in the lines below it waits for the next, and the last for the first. The lines name what "
        "links them ('Parent', a constraint, a driver): take one of these links away, or let it read something that "
        "does not depend on what it moves.",
    ),
    NamelessMessage(
        ("This slot (", "does not belong to the assigned Action"),
        (f"{T}AnimData.action_slot", f"{T}AnimData.action", f"{T}AnimData.action_suitable_slots"),
        "Assign the action that the slot is of before: `animation_data.action = action`, then "
        "`animation_data.action_slot = action.slots[0]`, or one of its `animation_data.action_suitable_slots`.",
    ),
)
