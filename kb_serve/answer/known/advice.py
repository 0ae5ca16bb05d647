"""Sentences on what one has to know of a few symbols that neither Blender's API nor its manual says."""

from __future__ import annotations

from kb_build.symbols.api_names import CHANGING_MODE, HANDLERS, OF_SELECTED, TYPES
from kb_build.symbols.lines import GET_EVALUATED
from kb_serve.answer.known.told_of import Advice, of, stems
from kb_serve.recognise.code.products import CLASSES, WITH_AT
from kb_serve.recognise.elsewhere.elements import ADDS_BOID_RULE
from kb_serve.recognise.messages.keys import KEY_OF_SLOTS, SLOTTED
from kb_serve.recognise.messages.nameless.python import PLAIN_FUNCTION
from kb_serve.recognise.messages.nameless.rendering import OF_32_BITS
from kb_serve.recognise.messages.none_before import TAKES_NO_MODIFIER
from kb_serve.recognise.messages.ways_to_run import BAKES_FLUIDS, NO_FLUIDS

_STROKE = "_bpy_internal.grease_pencil.stroke.GreasePencilStroke"
_STYLE = f"{TYPES}MaterialGPencilStyle"
_RIGID_BODY = f"{TYPES}RigidBodyObject"
_RANGES = f"{TYPES}bpy_struct.id_properties_ui"
_PERSISTENT = f"{HANDLERS}persistent"

_STAYING = (
    f"A handler without `@{_PERSISTENT}` above it is gone after a file is loaded: it is removed before `load_post` "
    "would run it."
)
_TAGGED = (
    "A driver does not see a custom property that a script sets on another object than its own, or once the driver was "
    'evaluated, and stays invalid: after `owner["name"] = 3.0` call `owner.id_data.update_tag()`, also after each '
    "later change. One that is invalid already needs `driver.expression = driver.expression`, too."
)
_EVERY_POINT = (
    "Set `radius` and `opacity` of every point: the first `opacity` that is set in a drawing makes it 0 for all its "
    "other points, and strokes that are added after either was set begin with 0 of it."
)
_REACHED = (
    "`drawing.strokes[0]` is one, with `drawing = layer.frames[0].drawing`; `drawing.add_strokes([4])` makes a new "
    "one, of four points."
)
_FILLED = (
    "A fill is drawn where the stroke has a `fill_id` other than 0 (`drawing.strokes[0].fill_id = 1`), whatever the "
    "material's `show_fill` is: in the material's `grease_pencil.fill_color`, with the stroke's `fill_color` over it. "
    "It is black where no light falls, unless `layer.use_lights = False`."
)
_MOVED = (
    "A rigid body's simulation moves `ob.matrix_world`, not `ob.location` or `ob.rotation_euler`: call "
    "`scene.frame_set(frame)` for every frame from the first, then read `ob.matrix_world.translation`."
)
_STEPPED = (
    "Rigid and soft bodies are simulated from one frame to the next: `for frame in range(scene.frame_start, 51): "
    "scene.frame_set(frame)`. A jump to frame 50 leaves them where they were, and cloth somewhat elsewhere."
)
_HELD = (
    "A body that is `kinematic` stands where it is, or follows its keyframes. To let it go at frame 30: "
    '`body.kinematic = True`, `body.keyframe_insert("kinematic", frame=29)`, then `body.kinematic = False`, '
    '`body.keyframe_insert("kinematic", frame=30)`.'
)
_MULTIPLIED = (
    "Of two bodies that touch the product counts: 0.5 on 0.5 acts as 0.25 on 1 does, and nothing on 0 slows down, or "
    "bounces."
)
_CACHED = (
    "A simulation ends with its point cache, at frame 250 unless that is told otherwise, whatever the scene's "
    "`frame_end` is: `scene.rigidbody_world.point_cache.frame_end = 500`, for cloth and soft bodies that of the "
    "modifier, `modifier.point_cache.frame_end`."
)
_IN_ZONES = (
    "Simulations of geometry nodes are no point caches: `bpy.ops.object.simulation_nodes_cache_bake(selected=True)` "
    "bakes those of the selected objects."
)
_TYPED = (
    "`body` takes no keyframes. A handler sets it: `bpy.app.handlers.frame_change_pre.append(function)`, which gets "
    "the scene."
)
_FILMED = (
    "A film: `scene.render.image_settings.media_type = 'VIDEO'` comes first, then "
    "`scene.render.ffmpeg.format = 'MPEG4'`, `scene.render.ffmpeg.codec = 'H264'`, and "
    "`bpy.ops.render.render(animation=True)` renders it. With images as the medium, 'FFMPEG' is no value of "
    "`file_format`."
)
_COMPOSITOR = f"{TYPES}Scene.compositing_node_group"
_COMPOSED = (
    'A scene\'s compositor is a node group: `tree = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")`, '
    "`scene.compositing_node_group = tree`. What a NodeGroupOutput in it gets is the picture, once "
    "`tree.interface.new_socket(\"Image\", in_out='OUTPUT', socket_type='NodeSocketColor')` has made its input."
)
_COMPOSED_IN_SCENE = (
    "`scene.use_nodes = True` makes the tree of a scene's compositor, `scene.node_tree`, with a Render Layers and a "
    "Composite node."
)
_SHADED = (
    "In a viewport it is `area.spaces.active.shading`, of an area whose `type` is 'VIEW_3D' "
    "(`bpy.context.window_manager.windows[0].screen.areas`); `scene.display.shading` is that of Workbench's renders."
)
_OF_FORMER_PENCIL = (
    "A Grease Pencil object takes `obj.grease_pencil_modifiers.new(\"Noise\", 'GP_NOISE')` in Blender 4.2: "
    "`obj.modifiers.new` returns None for it."
)
_OF_SOCKET = (
    "An input of a node is animated by itself: "
    '`node.inputs["Emission Strength"].keyframe_insert("default_value", frame=1)`.'
)
_AS_MODIFIED = (
    "`ob.data` is the mesh without modifiers and simulations. As they make it at a frame, after "
    f"`scene.frame_set(frame)`: `evaluated = ob{GET_EVALUATED}`, "
    "`mesh = evaluated.to_mesh()`; in the world a vertex is at `evaluated.matrix_world @ mesh.vertices[0].co`. "
    "`evaluated.to_mesh_clear()` when it is read."
)
_PARENTED = (
    "A child stays where it is by `world = child.matrix_world.copy()`, then `child.parent = parent` (of a bone also "
    "`parent_type = 'BONE'` and `parent_bone`), then `child.matrix_world = world`, once "
    "`bpy.context.view_layer.update()` has brought both matrices up to date."
)
_OF_POSE = (
    "It is in the armature's own space: in the world at `ob.matrix_world @ bone.head`, or `@ bone.tail`."
)
_LINKED_TWICE = (
    "It stays in the collections that it is in. To move it, before: "
    "`for other in ob.users_collection: other.objects.unlink(ob)`."
)
_BUMPED_INTO = (
    "What cloth, a soft body or particles are to bump into needs a modifier of its own: "
    "`other.modifiers.new(\"Collision\", 'COLLISION')`."
)
_IN_RADIANS = "Angles are in radians: `ob.rotation_euler.z = math.radians(90)`."
_ONE_POINT = (
    "A new spline has one point already: `spline.points.add(len(path) - 1)`, of a 'BEZIER' one "
    "`spline.bezier_points.add(len(path) - 1)`, makes as many as there are places in `path`. A Bézier point's handles "
    "stay at the origin until they have a type: `point.handle_left_type = point.handle_right_type = 'AUTO'`."
)
_BASIS = (
    "The first shape key is the one that the others are relative to, and its `value` changes nothing: "
    '`ob.shape_key_add(name="Basis")` comes before that with the new shape.'
)
_EXPRESSED = (
    "An expression knows its driver's variables, `frame`, the functions of Python's `math` without that name "
    "(`sin(frame / 10)`), `clamp`, `lerp`, `smoothstep`, `self` while `driver.use_self` is True, and a function of "
    'your own by `bpy.app.driver_namespace["name"] = name`, which a loaded file forgets: set it in a `load_post` '
    "handler, too."
)
_ADDED_TO_WORLD = (
    "`bpy.ops.rigidbody.world_add()` leaves the `collection` and the `constraints` of the world None. After "
    '`scene.rigidbody_world.collection = bpy.data.collections.new("Bodies")` a script needs no selection: '
    "`scene.rigidbody_world.collection.objects.link(obj)` makes a rigid body of `obj`."
)
_WEIGHED = (
    "A canvas writes weights only for vertices that are in the group already: "
    "`group.add(range(len(mesh.vertices)), 0.0, 'REPLACE')` before."
)
_OF_AOV = (
    "An AOV is shown by its own name, `space.shading.render_pass = aov.name`, which the list has once the view layer "
    "has the AOV."
)
_RACED = (
    "A rigid body with a mesh for its shape ('CONVEX_HULL', 'MESH') and a modifier that moves with the frame "
    "(Collision, Wave) crashes Blender once in some hundred runs, as it begins to simulate, where its `mesh_source` is "
    "'DEFORM', the default, or 'FINAL': set `ob.rigid_body.mesh_source = 'BASE'` if the shape need not deform."
)
_OF_LAYER = (
    "It works on the objects that are selected in the view layer, and the active one, whichever `temp_override` gives: "
    "`bpy.ops.object.select_all(action='DESELECT')`, `obj.select_set(True)` and "
    "`bpy.context.view_layer.objects.active = obj` come before."
)
_MODE_OF_LAYER = (
    "It changes the mode of the view layer's active object, whichever one `temp_override` gives: "
    "`bpy.context.view_layer.objects.active = obj` comes before."
)
_EXPORTED = (
    "It exports the objects that are selected in the view layer, whichever `temp_override` gives: "
    "`obj.select_set(True)` comes before."
)
_NOT_BY_ALL = (
    "Some operators work on the view layer's active or selected objects, whatever an override gives, and tell of no "
    "error: those that change the mode, the exporters of OBJ, STL, PLY, glTF and USD, and "
    f"{', '.join(f'`{path}`' for path in sorted(OF_SELECTED))}."
)
_JOINED = (
    "In a script: `with bpy.context.temp_override(active_object=a, selected_editable_objects=[a, b]): "
    "bpy.ops.object.join()`; `a` stays."
)
_NO_BONE = "A new bone's `head` and `tail` are both at the armature's origin: set both, or it has no length."
_FLAT = (
    "A face that `mesh.from_pydata(…)` makes is flat (`use_smooth` False), one of `mesh.polygons.add(count)` smooth: "
    "`mesh.shade_smooth()` and `mesh.shade_flat()` set it for all."
)
_TAB = (
    "`ui_type` only says which tab of the panel is open: `bpy.ops.dpaint.type_toggle(type='CANVAS')` (or 'BRUSH') "
    "makes `canvas_settings` (`brush_settings`), which are None before, on the active object's modifier."
)
_RANGED = (
    '`ob["x"] = 1.0` makes the property, `ob.id_properties_ui("x").update(min=0.0, max=2.0, description="…")` gives it '
    "limits, which the panel keeps and scripts need not. Choices are named numbers: after "
    '`ob["mode"] = 0` call `….update(items=[("A", "First", ""), ("B", "Second", "")])`.'
)
_NO_TIMERS = (
    "Timers run between the events of a Blender with a window. Without one (`--background`, or `import bpy` in another "
    "Python) none ever runs: call the function yourself there."
)
_REPEATED = (
    "A function that returns a number is called again after as many seconds (`return 1.0`), one that returns None no "
    "more."
)
_BY_MODE = (
    "A new pose bone is turned by its `rotation_quaternion`: `rotation_euler` does nothing before "
    "`pose_bone.rotation_mode = 'XYZ'`."
)
_WANTS_MATERIAL = "'MATERIAL' crashes Blender as long as the object has no material: give it one before."
_NO_SIZES = "An empty list crashes Blender: `if sizes: data.add_{}(sizes)`. Each size is at least 1."
_NO_RETIMING = (
    "Assigning a key's `timeline_frame` may crash Blender: 5.1 where the scene has an earlier strip without such keys, "
    "4.5 always. Make keys where they shall be, `strip.retiming_keys.add(timeline_frame=20)`, which itself crashes "
    "Blender before 5.1; `strip.retiming_keys.reset()` removes all."
)
_NO_KEY = (
    "It makes no key, and returns None, at a frame outside the strip, as the default is for most, and on a strip that "
    "takes none."
)
_FALLS = (
    "Cloth does not use its own `gravity`, whatever it is: while `scene.use_gravity` is on it falls by "
    "`scene.gravity` times the cloth's `settings.effector_weights.gravity`."
)
_DRAGGED = (
    "A sheet falls no faster than 23.5 × `mass` / `air_damping` metres a second at 24 frames a second, whatever its "
    "size and faces: gravity × fps / 10 × `mass` / `air_damping`, with the mass of a vertex."
)
_BAKED = (
    "What is left out is not the default that is listed here, but what `scene.render.bake` has, where it has a setting "
    "of that name: `target`, `margin`, `use_clear`, `normal_space` …"
)
_BAKED_BY = (
    "`scene.cycles.bake_type` is what the button of the window bakes; `bpy.ops.object.bake` does not read it. Write "
    "the type there, `bpy.ops.object.bake(type='NORMAL')`: without it 'COMBINED' is baked."
)
_ALL = "`{}(indices=[])` {}, as if it were left out: call it only `if indices:`."
_COMPRESSED = (
    "Left out, `compress` is not False: the file is compressed as the one that was loaded last, and a new one where "
    "`bpy.context.preferences.filepaths.use_file_compression` is on. Write `compress=False` to have it uncompressed."
)
_UNREAD = (
    "`bpy.data.images['Render Result']` has no pixels to read, its size is 0 × 0: save it "
    "(`image.save_render(path)`), load that (`bpy.data.images.load(path)`), and read the loaded one's `pixels`."
)
_UNREAD_LAYERS = (
    "Python reads no pixels of a multilayer EXR: the size of the loaded image is 0 × 0. Write each pass to a file of "
    "its own and load that."
)
_LEFT_ALONE = (
    "`frame_set` evaluates what the view layers show: a material or light that nothing visible uses stays as it was, "
    "animated or not, and so does an object that is hidden (`hide_viewport`) or in an excluded collection."
)
_SLOTTED = (
    "An action moves nothing until one of its slots is given, too, which `x.action = action` need not do: set "
    "`x.action_slot = x.action_suitable_slots[0]` after it, or, of an action that has no slot yet, "
    "`x.action_slot = action.slots.new(obj.id_type, obj.name)`. `obj.keyframe_insert(…)` makes and gives one itself."
)
_UNRENDERED = (
    "`World.color` colours the viewport alone while `world.use_nodes` is on, as it always is from 5.0: what is "
    'rendered is `world.node_tree.nodes["Background"].inputs["Color"].default_value = (r, g, b, 1.0)`.'
)
_REFUSED_CLASS = (
    "Any other class than a subclass of one of Blender's raises `RuntimeError` (`missing bl_rna attribute`), not "
    "`ValueError`."
)
_CRASHING_CLASS = "A class of Python's own (`int`) crashes Blender."
_SIGNED = (
    "The scale is negative on all axes where the matrix mirrors (`matrix.is_negative`), whichever axis it mirrors: "
    "`Matrix.Diagonal((-1, 2, 3, 1))` gives (-1, -2, -3)."
)
_RULED = f"In a script: {ADDS_BOID_RULE}. Without it nothing is added, and {{'CANCELLED'}} is all that is returned."
_SMOOTHED = (
    "The Smooth by Angle modifier is a group of geometry nodes: `bpy.ops.object.shade_auto_smooth(angle=0.5)` adds it "
    "to the selected objects."
)
_SMOOTHED_IN_WINDOW = (
    "Without a window `bpy.ops.object.shade_auto_smooth` returns {'CANCELLED'} and adds nothing before Blender 5.0 "
    "(“Asset loading is unfinished”): append the node group `Smooth by Angle` of "
    "`geometry_nodes/smooth_by_angle.blend` in `bpy.utils.system_resource('DATAFILES', path=\"assets\")`, and give it "
    "to a modifier of type 'NODES'."
)
_MOVED_TERMINATOR = (
    "What an object has of it in `ob.cycles` changes no render from 4.5 on: set `ob.shadow_terminator_shading_offset` "
    "and `ob.shadow_terminator_geometry_offset`."
)
_RATED = (
    "A scene has `fps / fps_base` frames a second: 23.976 are `fps = 24` with `fps_base = 1.001`, 29.97 are `fps = 30` "
    "with it."
)
_FACES = "The lists hold the faces themselves (`BMFace`), not their indices."

_SIMULATED = stems("cloth physics rigid simulate simulation soft")
# By one of these a question asks why something ends, and not how it is read.
_ENDING = stems("250 end ends freeze freezes stop stops")
ADVICE: tuple[Advice, ...] = (
    Advice(
        _STAYING,
        beginning=(HANDLERS,),
        about=stems("handler persistent callback"),
        needs=_PERSISTENT,
    ),
    Advice(
        _NO_TIMERS,
        frozenset({"bpy.app.timers", "bpy.app.timers.register"}),
        about=stems("timer delay interval later second repeat periodic"),
    ),
    Advice(_REPEATED, frozenset({"bpy.app.timers"})),
    Advice(_BY_MODE, of("PoseBone.rotation_euler")),
    Advice(
        NO_FLUIDS,
        frozenset({"bpy.ops.object.quick_liquid", "bpy.ops.object.quick_smoke"})
        | of("FluidDomainSettings", "FluidModifier"),
        beginning=("bpy.ops.fluid.bake_",),
        explained=BAKES_FLUIDS,
        wherever=(
            stems("fluid smoke fire liquid"),
            stems("abort background crash headless terminate window"),
        ),
    ),
    Advice(PLAIN_FUNCTION, frozenset({"bpy.msgbus.subscribe_rna"})),
    Advice(_REFUSED_CLASS, frozenset({"bpy.utils.register_class"})),
    Advice(_CRASHING_CLASS, frozenset({"bpy.utils.register_class"}), since=(5, 1)),
    Advice(_SIGNED, frozenset({"mathutils.Matrix.to_scale", "mathutils.Matrix.decompose"})),
    Advice(_FACES, frozenset({"bpy_extras.bmesh_utils.bmesh_linked_uv_islands"})),
    Advice(
        _SMOOTHED,
        wherever=(stems("smooth"), stems("angle"), stems("modifier modifiers")),
        needs="bpy.ops.object.shade_auto_smooth",
    ),
    Advice(
        _SMOOTHED_IN_WINDOW,
        frozenset({"bpy.ops.object.shade_auto_smooth"}),
        wherever=(stems("smooth"), stems("angle"), stems("modifier modifiers")),
        since=(4, 1),
        before=(5, 0),
    ),
    Advice(
        _MOVED_TERMINATOR,
        of(
            "CyclesObjectSettings.shadow_terminator_offset",
            "CyclesObjectSettings.shadow_terminator_geometry_offset",
        ),
        wherever=(stems("terminator"), stems("shadow")),
        since=(4, 5),
    ),
    Advice(_RULED, frozenset({"bpy.ops.boid.rule_add"})),
    Advice(_NO_KEY, of("RetimingKeys.add")),
    Advice(_NO_RETIMING, of("RetimingKey", "RetimingKey.timeline_frame", "RetimingKeys", "RetimingKeys.add")),
    Advice(_DRAGGED, of("ClothSettings.air_damping")),
    Advice(_FALLS, of("ClothSettings.gravity")),
    Advice(_BAKED, frozenset({"bpy.ops.object.bake"})),
    Advice(_BAKED_BY, frozenset({"bpy.ops.object.bake"}) | of("CyclesRenderSettings.bake_type")),
    Advice(_COMPRESSED, frozenset({"bpy.ops.wm.save_as_mainfile", "bpy.ops.wm.save_mainfile"})),
    Advice(_UNREAD, of("Image.pixels", "Image"), asked=stems("render result")),
    Advice(
        _UNREAD,
        wherever=(stems("render rendered"), stems("image result"), stems("pixel pixels")),
        unless=stems("aspect baking cycles filter node resolution size texture"),
    ),
    Advice(_RATED, of("RenderSettings.fps", "RenderSettings.fps_base")),
    Advice(_UNRENDERED, of("World.color")),
    Advice(_MOVED, frozenset({_RIGID_BODY}), chapters_of=_RIGID_BODY),
    Advice(
        _MOVED,
        of("Object.location", "Object.rotation_euler"),
        # By one of these a question says that something else than a script or its keys moves the object.
        asked=stems("bake body bounce drop fall physics rigid roll settle simulate simulation"),
    ),
    Advice(
        _STEPPED,
        wherever=(
            _SIMULATED,
            stems("frame frames frame_set"),
            stems("after at get jump not only position read result skip step through without"),
        ),
        unless=stems("strip split sequencer") | _ENDING | stems("active begin kinematic start"),
    ),
    Advice(
        _HELD,
        of("RigidBodyObject.kinematic"),
        asked=stems("active begin hold kinematic release start starts until"),
    ),
    Advice(
        _CACHED,
        wherever=(
            _SIMULATED,
            stems("cache frame frames"),
            _ENDING,
        ),
    ),
    Advice(
        _STEPPED,
        wherever=(
            stems("bodies body cloth rigid rigidbody soft"),
            stems("don doesn never no not nothing still"),
            stems("fall happen happens move moves run runs simulate"),
        ),
    ),
    Advice(
        _FILMED,
        wherever=(
            stems("ffmpeg film h264 movie mp4 mpeg4"),
            stems("animation export output render save set"),
        ),
        unless=stems("transparent transparency"),
        needs=f"{TYPES}ImageFormatSettings.media_type",
    ),
    *(
        Advice(
            text,
            wherever=(
                stems("compositing compositor"),
                stems("build create enable python script set setup"),
            ),
            needs=needs,
        )
        for text, needs in ((_COMPOSED, _COMPOSITOR), (_COMPOSED_IN_SCENE, f"{TYPES}Scene.node_tree"))
    ),
    Advice(
        _SHADED,
        beginning=(f"{TYPES}View3DShading",),
        asked=stems("material rendered solid viewport wireframe"),
    ),
    Advice(
        _OF_FORMER_PENCIL,
        wherever=(stems("gpencil pencil"), stems("modifier modifiers")),
        before=(4, 3),
    ),
    Advice(
        _OF_SOCKET,
        wherever=(
            stems("animate keyframe keyframes"),
            stems("material node shader socket"),
            stems("color colour emission roughness strength value"),
        ),
        unless=stems("default"),  # who writes that knows it
    ),
    Advice(
        _AS_MODIFIED,
        wherever=(
            stems("deformed evaluated"),
            stems("coordinates geometry mesh positions vertex vertices"),
            stems("evaluated export get read result"),
        ),
        unless=stems("closure domain"),  # nodes of these names evaluate something else
    ),
    Advice(
        _AS_MODIFIED,
        wherever=(
            stems("after"),
            stems("coordinates positions vertex vertices"),
            stems("armature cloth modifier modifiers simulation"),
        ),
    ),
    Advice(
        _PARENTED,
        of("Object.parent", "Object.matrix_parent_inverse"),
        asked=stems("jump keep move offset stay"),
    ),
    Advice(_OF_POSE, of("PoseBone.head", "PoseBone.tail"), asked=stems("global position space world")),
    Advice(
        _LINKED_TWICE, of("CollectionObjects.link", "CollectionObjects.unlink"), asked=stems("another move")
    ),
    Advice(
        _BUMPED_INTO,
        wherever=(
            stems("cloth particles soft"),
            stems("bump collide collides colliding collision"),
            stems("floor ground object objects other setup sphere table"),
        ),
    ),
    Advice(_IN_ZONES, frozenset({"bpy.ops.ptcache.bake_all"}), asked=stems("geometry node nodes zone")),
    Advice(TAKES_NO_MODIFIER, of("ObjectModifiers.new"), asked=stems("none nothing fails silently")),
    Advice(_TYPED, of("TextCurve.body"), asked=stems("animate change counter frame keyframe over time")),
    Advice(_IN_RADIANS, wherever=(stems("degree degrees"), stems("angle euler rotate rotation"))),
    Advice(
        _ONE_POINT,
        of("CurveSplines.new", "SplinePoints.add", "SplineBezierPoints.add"),
        about=stems("bezier curve points spline"),
    ),
    Advice(
        _BASIS,
        wherever=(
            stems("shape"),
            stems("key keys shapekey"),
            stems("basis effect first no nothing same single work"),
        ),
    ),
    Advice(
        _EXPRESSED,
        wherever=(stems("driver drivers"), stems("cos expression function functions math scripted sin")),
    ),
    Advice(
        _ADDED_TO_WORLD,
        of("RigidBodyWorld.collection", "RigidBodyWorld.constraints"),
        wherever=(stems("rigid rigidbody"), stems("nonetype none select selecting selection without")),
    ),
    Advice(
        _WEIGHED,
        of("DynamicPaintSurface.output_name_a", "DynamicPaintSurface.surface_type")
        | {"bpy.ops.dpaint.output_toggle"},
        asked=stems("weight group vertex"),
    ),
    Advice(_OF_AOV, of("View3DShading.render_pass"), asked=stems("aov")),
    Advice(_MULTIPLIED, of("RigidBodyObject.friction", "RigidBodyObject.restitution")),
    Advice(
        _EXPORTED,
        frozenset(
            {
                "bpy.ops.export_scene.gltf",
                "bpy.ops.wm.obj_export",
                "bpy.ops.wm.ply_export",
                "bpy.ops.wm.stl_export",
                "bpy.ops.wm.usd_export",
            }
        ),
        asked=stems("override temp_override"),
    ),
    Advice(
        _LEFT_ALONE,
        of("Scene.frame_set"),
        asked=stems("animated animation evaluate evaluated material stay stays same unchanged update"),
    ),
    Advice(
        _UNREAD_LAYERS,
        wherever=(stems("multilayer"), stems("0 empty load loaded pixels read reading size zero")),
        unless=stems("save write"),
    ),
    Advice(_JOINED, frozenset({"bpy.ops.object.join"})),
    Advice(_OF_LAYER, OF_SELECTED),
    Advice(_MODE_OF_LAYER, CHANGING_MODE, asked=stems("context override")),
    Advice(_NOT_BY_ALL, of("Context.temp_override")),
    Advice(_NO_BONE, of("ArmatureEditBones.new")),
    Advice(_FLAT, of("MeshPolygon.use_smooth")),
    Advice(_TAB, of("DynamicPaintModifier", "DynamicPaintModifier.ui_type")),
    Advice(_RACED, of("RigidBodyObject.mesh_source", "CollisionModifier")),
    Advice(
        _RANGED,
        frozenset({_RANGES}),
        explained=_RANGES,
        about=stems("property custom limit range min max slider ui"),
    ),
    Advice(
        _SLOTTED,
        of(
            "ActionConstraint.action",
            "ActionSlots.new",
            "AnimData.action",
            "BlendDataActions.new",
            "NlaStrip.action",
        ),
        about=stems("action"),
        needs=f"{TYPES}AnimData.action_slot",
    ),
    Advice(OF_32_BITS, of("bpy_prop_array.foreach_get", "bpy_prop_array.foreach_set")),
    Advice(KEY_OF_SLOTS, of("Action.slots", "ActionSlots"), needs=SLOTTED),
    Advice(
        WITH_AT,
        frozenset(CLASSES),
        about=stems("apply matrix multiply multiplication operator product rotate times transform world"),
    ),
    Advice(
        _TAGGED,
        of(
            "ChannelDriverVariables.new",
            "Driver",
            "Driver.is_valid",
            "DriverTarget",
            "DriverTarget.data_path",
            "DriverVariable",
            "bpy_struct.driver_add",
        ),
        about=stems("driver driven drive"),
    ),
    Advice(
        _REACHED,
        frozenset({_STROKE}),
        beginning=(f"{_STROKE}.",),
    ),
    Advice(
        _FILLED,
        frozenset(f"{_STROKE}.{name}" for name in ("fill_color", "fill_id", "fill_opacity"))
        | {
            f"{_STYLE}{name}" for name in ("", ".fill_color", ".fill_style", ".is_fill_visible", ".show_fill")
        },
        explained=_STYLE,
        since=(5, 0),
    ),
    Advice(_EVERY_POINT, frozenset(f"{_STROKE}Point{name}" for name in ("", ".opacity", ".radius"))),
    Advice(_WANTS_MATERIAL, of("GreasePencilOffsetModifier.offset_mode")),
    Advice(_NO_SIZES.format("strokes"), of("GreasePencilDrawing.add_strokes")),
    Advice(_NO_SIZES.format("curves"), of("Curves.add_curves")),
    Advice(_ALL.format("remove_strokes", "removes all strokes"), of("GreasePencilDrawing.remove_strokes")),
    Advice(_ALL.format("set_types", "sets the type of all strokes"), of("GreasePencilDrawing.set_types")),
    Advice(_ALL.format("remove_curves", "removes all curves"), of("Curves.remove_curves")),
    Advice(_ALL.format("set_types", "sets the type of all curves"), of("Curves.set_types")),
)
