"""Messages of objects, collections and view layers that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_ANNOTATION = "ID type 'GREASEPENCIL' is not valid for an object"

OBJECTS = (
    NamelessMessage(
        ("is only valid for bpy.data collections, not ",),
        (f"{T}BlendData",),
        "Two values in brackets are a name and a library, and only collections of `bpy.data` take those: give one "
        "name or one number.",
    ),
    NamelessMessage(
        ("bpy_prop_collection[key] = value: invalid, expected a StructRNA type or None, not a str",),
        (f"{T}IDMaterials.append", f"{T}BlendData.materials"),
        'Give the thing itself, not its name: `mesh.materials[0] = bpy.data.materials["Wood"]`.',
    ),
    NamelessMessage(
        ("No Rigid Body World to ",),
        ("bpy.ops.rigidbody.world_add", f"{T}Scene.rigidbody_world"),
        "`bpy.ops.rigidbody.world_add()` makes the world of the scene; `bpy.ops.rigidbody.object_add()` makes one "
        "where none is.",
    ),
    NamelessMessage(
        ("Expected an evaluated object",),
        (f"{T}ID.evaluated_get", f"{T}Object.evaluated_geometry"),
        "Ask the evaluated object: `obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()`.",
    ),
    NamelessMessage(
        (" not in View Layer '",),
        (f"{T}Object.select_set", f"{T}CollectionObjects.link"),
        "The object is in no collection of the view layer: `scene.collection.objects.link(obj)` first.",
    ),
    NamelessMessage(
        ("ViewLayer '", "does not contain object '"),
        (f"{T}LayerObjects.active", f"{T}CollectionObjects.link"),
        "The object is in no collection of the view layer: `scene.collection.objects.link(obj)` first.",
    ),
    NamelessMessage(
        ("Object '", "already in collection '"),
        (f"{T}CollectionObjects.link",),
        "Link it only where it is not yet: `if obj.name not in collection.objects:`. What operators add is linked.",
    ),
    NamelessMessage(
        ("Collection '", "already in collection '"),
        (f"{T}CollectionChildren.link",),
        "Link it only where it is not yet: `if child.name not in collection.children:`. The same is said where it "
        "would hold itself: the collection is below it already (`child.children_recursive`), or it is the scene's own.",
    ),
    NamelessMessage(
        ("Object '", "not in collection '"),
        (f"{T}CollectionObjects.unlink", f"{T}Object.users_collection"),
        "Unlink it only where it is: `if obj.name in collection.objects:`. `obj.users_collection` are the collections "
        "that it is in, none while it is new; unlinked from all of them, it is in no scene.",
    ),
    NamelessMessage(
        ("has no evaluated mesh data",),
        (f"{T}Object.ray_cast", f"{T}Object.closest_point_on_mesh", f"{T}ID.evaluated_get"),
        "The object must be in the view layer and computed: link it, then `bpy.context.view_layer.update()`.",
    ),
    NamelessMessage(
        (_ANNOTATION,),
        (f"{T}BlendDataGreasePencilsV3.new", f"{T}BlendDataObjects.new"),
        "`bpy.data.grease_pencils` holds annotations in this Blender. An object takes what is made by "
        "`bpy.data.grease_pencils_v3.new(name)`.",
    ),
    NamelessMessage(
        (_ANNOTATION,),
        (f"{T}BlendDataGreasePencils.new", f"{T}BlendDataObjects.new"),
        "No object has annotations. It takes what is made by `bpy.data.grease_pencils.new(name)`.",
        lacking=f"{T}BlendDataGreasePencilsV3.new",
    ),
    NamelessMessage(
        ("ID type '", "is not valid for an object"),
        (f"{T}BlendDataObjects.new", f"{T}ID.copy"),
        "The second argument is the data, not an object: `bpy.data.objects.new(name, obj.data)`. `obj.copy()` "
        "copies an object.",
        without=(_ANNOTATION,),
    ),
    NamelessMessage(
        ("This data does not support joining in edit mode",),
        ("bpy.ops.object.join", "bpy.ops.object.mode_set"),
        "`bpy.ops.object.mode_set(mode='OBJECT')` comes before.",
    ),
    NamelessMessage(
        ("is invalid when no pose bone is given",),
        (f"{T}Object.convert_space",),
        "Give the bone: `rig.convert_space(pose_bone=rig.pose.bones[\"Bone\"], matrix=matrix, from_space='WORLD', "
        "to_space='POSE')`.",
    ),
    NamelessMessage(
        ("expected a sequence of float, not ",),
        (f"{T}Object.matrix_world", "mathutils.Matrix"),
        "A matrix is given as one, or as rows, `((1, 0, 0, 0), (0, 1, 0, 0), …)`, not as 16 numbers.",
    ),
)
