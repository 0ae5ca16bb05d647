"""Mistakes with things that a script has just made: each is run in Blender, which refuses the wrong ones only."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_FLUID = "bpy.ops.mesh.primitive_cube_add()\nfluid = bpy.context.object.modifiers.new('Fluid', 'FLUID')\n"
_CUBE = "bpy.ops.mesh.primitive_cube_add()\n"
_OBJECT = "ob = bpy.data.objects.new('x', None)\n"
_TREE = "tree = bpy.data.node_groups.new('x', 'GeometryNodeTree')\n"
_POINTS = _TREE + "points = tree.nodes.new('GeometryNodeDistributePointsOnFaces')\n"
_ZONE = _TREE + "first = tree.nodes.new('GeometryNodeSimulationInput')\n"
_GLARE = "tree = bpy.data.node_groups.new('x', 'CompositorNodeTree')\nglare = tree.nodes.new('CompositorNodeGlare')\n"
_ARMATURE = "armature = bpy.data.armatures.new('x')\nob = bpy.data.objects.new('x', armature)\n"
_MIX = "mix = bpy.data.node_groups.new('x', 'ShaderNodeTree').nodes.new('ShaderNodeMix')\nmix.data_type = 'RGBA'\n"
_IMAGES = "images = bpy.context.scene.render.image_settings\n"
_PARTICLES = "hair = bpy.data.particles.new('x')\nhair.type = 'HAIR'\n"
_ACTION = "action = bpy.data.actions.new('x')\n" + _OBJECT + "ob.animation_data_create().action = action\n"
_COMPOSITOR = "tree = bpy.data.node_groups.new('x', 'CompositorNodeTree')\n"
_OUTPUT = _COMPOSITOR + "out = tree.nodes.new('CompositorNodeOutputFile')\n"
_NODES = _CUBE + "nodes = bpy.context.object.modifiers.new('x', 'NODES')\n"
_MESH = "ob = bpy.data.objects.new('x', bpy.data.meshes.new('x'))\n"
_OTHER_FLUID = "other = bpy.data.objects.new('y', bpy.data.meshes.new('y')).modifiers.new('Fluid', 'FLUID')\n"
_PAINT = _CUBE + "paint = bpy.context.object.modifiers.new('Paint', 'DYNAMIC_PAINT')\n"
_STRIP = (
    "action = bpy.data.actions.new('x')\nslot = action.slots.new('OBJECT', 'x')\n"
    "strip = action.layers.new('x').strips.new(type='KEYFRAME')\n"
)
_CURVE = "curve = bpy.data.curves.new('x', 'CURVE')\n"
_STRIPS = (
    "strips = bpy.context.scene.sequence_editor_create().strips\n"
    "red = strips.new_effect('x', 'COLOR', 1, 1, length=9)\nblue = strips.new_effect('y', 'COLOR', 2, 1, length=9)\n"
)
_RANDOM = _TREE + "random = tree.nodes.new('FunctionNodeRandomValue')\n"
_SWITCH = _TREE + "switch = tree.nodes.new('GeometryNodeSwitch')\n"
_BACKGROUND = "shader = bpy.data.node_groups.new('x', 'ShaderNodeTree').nodes.new('ShaderNodeBackground')\n"
_INTERFACE = _TREE + "tree.interface.new_socket('Mesh', socket_type='NodeSocketGeometry')\n"
_SIMULATED = (
    _ZONE + "second = tree.nodes.new('GeometryNodeSimulationOutput')\nfirst.pair_with_output(second)\n"
)
_RESET = "bpy.ops.wm.read_factory_settings(use_empty=True)\n"
_PARTS = (
    "class Part(bpy.types.PropertyGroup): pass\n"
    "bpy.utils.register_class(Part)\n"
    "bpy.types.Scene.parts = bpy.props.CollectionProperty(type=Part)\n"
)
_DRIVER = _OBJECT + "variable = ob.driver_add('location', 0).driver.variables.new()\n"
WRONG = {
    "empty-pointer": [
        _FLUID + "fluid.domain_settings.domain_type = 'LIQUID'",
        _FLUID + "settings = fluid.flow_settings\nsettings.flow_type = 'SMOKE'",
        _FLUID + "fluid.fluid_type = 'FLOW'\nfluid.domain_settings.domain_type = 'LIQUID'",
        _FLUID + _OTHER_FLUID + "other.fluid_type = 'DOMAIN'\nfluid.domain_settings.domain_type = 'LIQUID'",
        _PAINT + "bpy.ops.dpaint.type_toggle(type='CANVAS')\npaint.brush_settings.paint_color = (1, 0, 0)",
        "dust = bpy.data.particles.new('x')\ndust.physics_type = 'FLUID'\ndust.boids.health = 1",
        _STRIP + "strip.channelbag(slot).fcurves.new('location')",
        _STRIP + "bag = strip.channelbag(slot)\nbag.fcurves.new('location')",
        _OBJECT + "ob.field.type = 'WIND'",
        _OBJECT + "ob.animation_data.use_nla = True",
        _CUBE + "bpy.context.object.rigid_body.mass = 2",
        _CUBE + "cube = bpy.context.active_object\ncube.rigid_body.mass = 2",
        _NODES + "nodes.node_group.interface.new_socket('x')",
        _NODES + "group = nodes.node_group\ngroup.nodes.new('NodeReroute')",
        "bpy.data.scenes.new('x').compositing_node_group.nodes",
        _CUBE + "material = bpy.context.object.active_material\nmaterial.use_nodes = True",
        _MESH + "ob.active_material.diffuse_color = (1, 0, 0, 1)",
        _MESH + "ob.parent.location.x = 1",
        _MESH + "ob.constraints.new('COPY_LOCATION').target.location.x = 1",
        _MESH + "ob.pose.bones['x']",
        _MESH + "ob.asset_data.tags.new('x')",
        _CUBE + "bpy.context.object.asset_data.description = 'x'",
        _CUBE + "cube = bpy.context.object\ncube.pose.bones['x'].location.x = 1",
        _TREE + "tree.nodes.new('GeometryNodeGroup').node_tree.nodes",
        "bpy.data.materials.new('x').grease_pencil.color = (1, 0, 0, 1)",
    ],
    "hidden-socket": [
        _POINTS + "points.inputs['Density Max'].default_value = 3",
        _TREE + "cut = tree.nodes.new('GeometryNodeMeshBoolean')\ncut.operation = 'UNION'\n"
        "cut.inputs['Self Intersection'].default_value = True",
        _ZONE + "first.inputs['Geometry']",
        _ZONE + "second = tree.nodes.new('GeometryNodeSimulationOutput')\n"
        "tree.links.new(first.outputs['Geometry'], second.inputs['Geometry'])\nfirst.pair_with_output(second)",
    ],
    "unknown-value": [
        "bpy.data.node_groups.new('x', 'CompositorTree')",
        "bpy.ops.export_scene.gltf(filepath='/x', export_format='GLTF')",
        "bpy.context.scene.cycles.sampling_pattern = 'SOBOL'",
        "bpy.data.actions.new('x').layers.new('x').strips.new(type='FRAMES')",
        _GLARE + "glare.inputs['Type'].default_value = 'FOG_GLOW'",
        _TREE + "tree.interface.new_socket('x', socket_type='NodeSocketFloatFactor')",
        "bpy.data.node_groups.new('x', 'NodeTree')",
        "bpy.data.node_groups.new('x', 'GeometryNodes')",
        "bpy.data.node_groups.new('x', 'GeometryNode')",
        "bpy.data.node_groups.new('x', 'ShaderNodes')",
        "bpy.data.node_groups.new(name='x', type='GEOMETRY')",
        "bpy.data.node_groups.new('x', 'COMPOSITING')",
    ],
    "list-attribute": [
        _OBJECT + "ob.driver_add('location').driver",
        _OBJECT + "curve = ob.driver_add('scale')\ncurve.driver.expression = '1'",
    ],
    "not-animated": [_ACTION + "ob.animation_data.action_slot = action.slots.new('ACTION', 'x')"],
    "unknown-socket": [
        _MIX + "mix.inputs['A_Color']",
        _MIX + "mix.outputs['Result_Color']",
        _MIX + "mix.inputs['Fac']",
        _TREE + "tree.nodes.new('FunctionNodeRandomValue').inputs['Max_001']",
        _TREE + "start = tree.nodes.new('NodeGroupInput')\nstart.outputs['Geometry']",
        _INTERFACE + "tree.nodes.new('NodeGroupInput').outputs['Geometry']",
        _INTERFACE + "tree.nodes.new('NodeGroupOutput').inputs['Mesh']",
        _SIMULATED + "first.outputs['Speed']",
        _SIMULATED + "second.state_items.new('VECTOR', 'Speed')\nfirst.outputs['Velocity']",
        _TREE + "bundle = tree.nodes.new('NodeSeparateBundle')\nbundle.bundle_items.new('FLOAT', 'x')\n"
        "bundle.outputs['y']",
    ],
    "refused-value": [
        _RESET + "bpy.context.scene.render.image_settings.file_format = 'FFMPEG'",
        "bpy.context.scene.render.image_settings.file_format = 'OPEN_EXR_MULTILAYER'",
        "render = bpy.context.scene.render\nrender.image_settings.file_format = 'FFMPEG'",
        "images = bpy.context.scene.render.image_settings\nimages.file_format = 'FFMPEG'\nimages.media_type = 'VIDEO'",
        _OUTPUT + "out.format.file_format = 'PNG'",
        _OUTPUT + "settings = out.format\nsettings.file_format = 'OPEN_EXR'",
        _OUTPUT + "out.format.media_type = 'VIDEO'",
        _OUTPUT + "settings = out.format\nsettings.media_type = 'VIDEO'",
        "bpy.context.scene.render.image_settings.file_format = 'FFMPEG'",
        _IMAGES + "images.media_type = 'VIDEO'\nimages.color_mode = 'RGB'\nimages.file_format = 'PNG'",
        _IMAGES + "images.file_format = 'JPEG'\nimages.color_mode = 'RGBA'",
        _IMAGES + "images.file_format = 'HDR'\nimages.color_mode = 'RGBA'",
        _IMAGES + "images.file_format = 'JPEG'\nimages.color_depth = '16'",
        _IMAGES + "images.file_format = 'OPEN_EXR'\nimages.color_depth = '10'",
        _PARTICLES + "hair.render_type = 'HALO'",
        _TREE + "tree.interface.new_socket('x', socket_type='NodeSocketShader')",
        _TREE + "tree.color_tag = 'SHADER'",
        "bpy.ops.object.effector_add(type='VORTEX')\nbpy.context.object.field.shape = 'LINE'",
        "bpy.ops.object.effector_add(type='WIND')\nfield = bpy.context.object.field\nfield.type = 'VORTEX'\n"
        "field.shape = 'LINE'",
        "tree = bpy.data.node_groups.new('x', 'CompositorNodeTree')\n"
        "tree.interface.new_socket('x', socket_type='NodeSocketGeometry')",
        "tree = bpy.data.node_groups.new('x', 'CompositorNodeTree')\nitems = tree.interface\n"
        "items.new_socket('x', socket_type='NodeSocketGeometry')",
        "curve = bpy.data.curves.new('x', 'CURVE')\ncurve.dimensions = '3D'\ncurve.fill_mode = 'BOTH'",
        _CURVE + "curve.fill_mode = 'FULL'",
        "curve = bpy.data.curves.new('x', 'FONT')\ncurve.fill_mode = 'FULL'",
        _OBJECT + "held = ob.constraints.new('COPY_ROTATION')\nheld.owner_space = 'POSE'",
        _TREE + "compare = tree.nodes.new('FunctionNodeCompare')\ncompare.data_type = 'BOOLEAN'",
        "bpy.context.scene.render.image_settings.color_depth = '32'",
        "from bpy_extras.view3d_utils import location_3d_to_region_2d\n"
        + _OUTPUT
        + "out.format.file_format = 'PNG'",
    ],
    "wrong-type": [
        _TREE + "tree.interface.new_socket('x', description=None)",
        _CURVE + "spline = curve.splines.new('NURBS')\nspline.order_u = '4'",
        _RANDOM + "random.inputs['Max'].default_value = (1, 2, 3)",
        _RANDOM + "random.data_type = 'FLOAT_VECTOR'\nrandom.inputs['Max'].default_value = 1.0",
        _RANDOM + "random.data_type = 'INT'\nrandom.inputs['Max'].default_value = 1.5",
        _SWITCH + "switch.input_type = 'FLOAT'\nswitch.inputs['True'].default_value = (1, 2, 3)",
        "mix = bpy.data.node_groups.new('x', 'ShaderNodeTree').nodes.new('ShaderNodeMix')\n"
        "mix.inputs['A'].default_value = (1, 0, 0, 1)",
        _MIX + "mix.inputs['B'].default_value = 0.5",
        "armature = bpy.data.armatures.new('x')\narmature.collections.new('x').assign('Bone')",
        "armature = bpy.data.armatures.new('x')\narmature.collections.new('x').assign([1])",
        _DRIVER + "variable.targets[0].id = bpy.context.scene",
        _DRIVER + "target = variable.targets[0]\ntarget.id = bpy.data.materials.new('x')",
    ],
    "missing-argument": [
        _CUBE + "bpy.context.object.data.color_attributes.new('x', 'FLOAT_COLOR')",
        _CUBE + "data = bpy.context.object.data\ndata.attributes.new(name='x', type='FLOAT')",
        _PARTS + "bpy.context.scene.parts.move(0)",
        _PARTS + "bpy.context.scene.parts.remove()",
    ],
    "read-only": [
        _STRIPS
        + "cross = strips.new_effect('z', 'CROSS', 3, 1, input1=red, input2=blue)\ncross.left_handle = 3",
        _STRIPS + "glow = strips.new_effect('z', 'GLOW', 3, 1, input1=red)\nglow.duration = 3",
    ],
    "unknown-name": [
        "import bgl",
        "from bgl import glEnable",
        "bpy.utils.previews.new()",
        "import gpu_extras\ngpu_extras.batch.batch_for_shader",
        "import gpu_extras.batch\ngpu_extras.presets.draw_circle_2d",
    ],
    "refused-call": [
        "curve = bpy.data.curves.new('x', 'CURVE')\ncurve.splines.new('POLY').bezier_points.add(2)",
        "curve = bpy.data.curves.new('x', 'CURVE')\ncurve.splines.new(type='BEZIER').points.add(2)",
    ],
    "unknown-attribute": [
        "bpy.context.scene.cycles.use_denoise = True",
        "bpy.context.view_layer.cycles.use_pass_debug_sample_count = True",
        "bpy.context.scene.cycles.use_square_samples = True",
        "bpy.data.lights.new('x', 'POINT').cycles.cast_shadow = True",
        _CUBE + "bpy.context.object.data.face_maps",
        _CURVE + "spline = curve.splines.new('POLY')\nspline.use_cyclic = True",
        _CURVE + "curve.splines.new(type='BEZIER').closed = True",
        "ball = bpy.data.metaballs.new('x').elements.new(type='BALL')\nball.rad = 2",
        "strip = bpy.data.actions.new('x').layers.new('x').strips.new(type='KEYFRAME')\nstrip.channelbg",
        _STRIPS + "sound = strips.new_sound('x', '/x.wav', 3, 1)\nsound.transform.scale_x = 2",
        _SWITCH + "switch.input_type = 'GEOMETRY'\nswitch.inputs['True'].default_value = 1",
    ],
    "unknown-operator": ["bpy.ops.import_mesh.stl(filepath='/x.stl')"],
    "not-in-edit-mode": [
        _ARMATURE + "def bone():\n    armature.edit_bones.new('x')\nbone()",
    ],
}
RIGHT = [
    _CUBE + "bpy.context.object.data.color_attributes.new('x', 'FLOAT_COLOR', 'POINT')",
    "bpy.context.scene.cycles.sampling_pattern = 'TABULATED_SOBOL'",
    _CUBE + "bpy.ops.transform.rotate(value=1, orient_type='GIMBAL')",
    "material = bpy.data.materials.new('x')\nbpy.data.materials.create_gpencil_data(material)\n"
    "material.grease_pencil.color = (1, 0, 0, 1)",
    _CURVE + "curve.fill_mode = 'BOTH'\ncurve.splines.new('NURBS').use_cyclic_u = True",
    "bpy.data.curves.new('x', 'SURFACE').fill_mode = 'FULL'",
    "surface = bpy.data.curves.new('x', 'SURFACE')\nsurface.fill_mode = 'FULL'",
    _ARMATURE + "bpy.context.collection.objects.link(ob)\nbpy.context.view_layer.objects.active = ob\n"
    "bpy.ops.object.mode_set(mode='EDIT')\narmature.edit_bones.new('x').tail = (0, 0, 1)\n"
    "bpy.ops.object.mode_set(mode='OBJECT')\nbone = ob.pose.bones['x']\nheld = bone.constraints.new('COPY_ROTATION')\n"
    "held.owner_space = 'POSE'\ngroup = armature.collections.new('x')\ngroup.assign(bone)\ngroup.assign(bone.bone)",
    _STRIPS
    + "red.left_handle = 3\ntext = strips.new_effect('z', 'TEXT', 3, 1, length=9)\ntext.duration = 4\n"
    "strips.new_image('i', '/x.png', 4, 1).transform.scale_x = 2\nstrips.new_meta('m', 5, 1).strips.new_effect("
    "'n', 'COLOR', 1, 1, length=9)",
    _RANDOM + "random.inputs['Max'].default_value = 1.5\nrandom.inputs[1].default_value = (1, 2, 3)",
    _RANDOM + "random.data_type = 'FLOAT_VECTOR'\nrandom.inputs['Max'].default_value = (1, 2, 3)",
    _RANDOM + "other = random\nother.data_type = 'INT'\nrandom.inputs['Max'].default_value = 3",
    _RANDOM + "def turn(node):\n    node.data_type = 'FLOAT_VECTOR'\nturn(random)\n"
    "random.inputs['Max'].default_value = (1, 2, 3)",
    _SWITCH + "switch.input_type = 'BOOLEAN'\nswitch.inputs['True'].default_value = True",
    _SWITCH + "switch.input_type = 'RGBA'\nswitch.inputs['True'].default_value = (1, 0, 0, 1)",
    _TREE + "switch = tree.nodes.new('GeometryNodeIndexSwitch')\nswitch.data_type = 'VECTOR'\n"
    "switch.inputs[1].default_value = (1, 2, 3)",
    _BACKGROUND + "shader.inputs[2].default_value = 1\nprint('Weight' in shader.inputs)",
    _INTERFACE + "tree.nodes.new('NodeGroupInput').outputs['Mesh']",
    _INTERFACE + "tree.interface.new_socket('Mesh', in_out='OUTPUT', socket_type='NodeSocketGeometry')\n"
    "tree.nodes.new('NodeGroupOutput').inputs['Mesh']",
    _TREE + "for name in ('A', 'B', 'C', 'D', 'E', 'F', 'G', 'H', 'I', 'J'):\n"
    "    tree.interface.new_socket(name, socket_type='NodeSocketFloat')\n"
    "tree.nodes.new('NodeGroupInput').outputs['A']",
    _TREE
    + "for number in range(3):\n    tree.interface.new_socket(f'V{number}', socket_type='NodeSocketFloat')\n"
    "tree.nodes.new('NodeGroupInput').outputs['V1']",
    _TREE
    + "item = tree.interface.new_socket('x', socket_type='NodeSocketFloat')\nitem.name = 'Size'.upper()\n"
    "tree.nodes.new('NodeGroupInput').outputs['SIZE']",
    _SIMULATED + "second.state_items.new('VECTOR', 'Speed')\nfirst.outputs['Speed']\nsecond.inputs['Speed']\n"
    "first.outputs['Geometry']\nsecond.state_items.new('FLOAT', '')\nfirst.outputs['Float']",
    _TREE + "bundle = tree.nodes.new('NodeCombineBundle')\nbundle.bundle_items.new('FLOAT', 'x')\n"
    "bundle.bundle_items.new('FLOAT', 'x')\nbundle.inputs['x_001']",
    "bpy.ops.wm.read_factory_settings(app_template='Video_Editing')\n"
    "bpy.context.scene.render.image_settings.file_format = 'FFMPEG'",
    _RESET + "bpy.context.scene.render.image_settings.file_format = 'JPEG'",
    _OUTPUT + "out.format.file_format = 'OPEN_EXR_MULTILAYER'",
    _OUTPUT + "out.format.media_type = 'IMAGE'\nout.format.file_format = 'PNG'",
    _NODES
    + "nodes.node_group = bpy.data.node_groups.new('x', 'GeometryNodeTree')\nnodes.node_group.interface.active",
    _NODES + "if nodes.node_group:\n    nodes.node_group.nodes",
    _NODES + "group = nodes.node_group\nif group is not None:\n    group.nodes",
    _NODES + "try:\n    nodes.node_group.nodes\nexcept AttributeError:\n    pass",
    "bpy.ops.mesh.primitive_cube_add()\nbpy.ops.node.new_geometry_nodes_modifier()\n"
    "bpy.context.object.modifiers[0].node_group.nodes",
    _CUBE + "bpy.context.object.data.materials.append(bpy.data.materials.new('x'))\n"
    "bpy.context.object.active_material.use_nodes = True",
    _CUBE + "bpy.ops.object.material_slot_add()\nslot = bpy.context.object.material_slots[0]\n"
    "slot.material = bpy.data.materials.new('x')\nbpy.context.object.active_material.use_nodes = True",
    "mesh = bpy.data.meshes.new('x')\nmesh.materials.append(bpy.data.materials.new('x'))\n"
    + _CUBE
    + "bpy.context.object.data = mesh\nbpy.context.object.active_material.use_nodes = True",
    _MESH + "ob.parent = bpy.data.objects.new('y', None)\nob.parent.location.x = 1",
    _ARMATURE
    + "bpy.context.collection.objects.link(ob)\nbpy.context.view_layer.update()\nlen(ob.pose.bones)",
    "bpy.ops.object.armature_add()\nbpy.context.object.pose.bones[0].location.x = 1",
    _CUBE + "bpy.ops.object.armature_add()\nbpy.context.object.pose.bones[0].location.x = 1",
    _MESH + "ob.asset_mark()\nob.asset_data.tags.new('x')",
    _MESH + "ob.asset_data",
    "curve = bpy.data.curves.new('x', 'CURVE')\ncurve.splines.new('BEZIER').bezier_points.add(2)",
    "curve = bpy.data.curves.new('x', 'CURVE')\ncurve.splines.new('NURBS').points.add(2)",
    "import bpy.utils.previews\nbpy.utils.previews.new()",
    "from bpy.utils import previews\nprevious = previews.new()\nbpy.utils.previews.remove(previous)",
    "import gpu_extras.batch as batch\nimport gpu_extras\ngpu_extras.batch",
    _MESH + "if ob.pose:\n    ob.pose.bones",
    "bpy.data.node_groups.new('x', 'GeometryNodeTree')",
    "class Tree(bpy.types.NodeTree):\n    bl_idname = 'ShaderNodeTreeX'\n    bl_label = 'x'\n    bl_icon = 'NONE'\n"
    "bpy.utils.register_class(Tree)\nbpy.data.node_groups.new('x', 'ShaderNodeTreeX')",
    _MIX + "mix.inputs['A'].default_value = (1, 0, 0, 1)\nmix.inputs[6]\nmix.outputs['Result']",
    _TREE + "tree.nodes.new('FunctionNodeRandomValue').inputs['Max']",
    _IMAGES + "images.media_type = 'VIDEO'\nimages.file_format = 'FFMPEG'",
    _IMAGES + "images.media_type = 'VIDEO'\nimages.media_type = 'IMAGE'\nimages.file_format = 'PNG'",
    _IMAGES + "def video():\n    images.media_type = 'VIDEO'\nvideo()\nimages.file_format = 'FFMPEG'",
    _IMAGES + "for kind in ('VIDEO', 'IMAGE'):\n    images.media_type = kind\n    break\n"
    "images.file_format = 'FFMPEG'\nimages.media_type = 'VIDEO'",
    _IMAGES + "images.media_type = 'VIDEO'\nimages = bpy.data.scenes.new('x').render.image_settings\n"
    "images.file_format = 'PNG'",
    _IMAGES + "def still():\n    images.media_type = 'IMAGE'\nimages.media_type = 'VIDEO'\nstill()\n"
    "images.file_format = 'PNG'",
    _IMAGES + "images.file_format = 'PNG'\nimages.color_depth = '16'\nimages.color_mode = 'RGBA'",
    _IMAGES + "images.file_format = 'AVIF'\nimages.color_depth = '10'\nimages.color_mode = 'RGBA'",
    _IMAGES
    + "bpy.context.scene.render.ffmpeg.codec = 'PNG'\nimages.file_format = 'JPEG'\nimages.color_mode = 'RGBA'",
    "bpy.ops.object.effector_add(type='WIND')\nbpy.context.object.field.shape = 'LINE'",
    _CUBE + "bpy.ops.object.forcefield_toggle()\nfield = bpy.context.object.field\nfield.type = 'WIND'\n"
    "field.shape = 'POINTS'",
    "bpy.ops.object.effector_add(type='GUIDE')\nbpy.context.object.field.shape = 'SURFACE'",
    _PARTICLES + "hair.type = 'EMITTER'\nhair.render_type = 'HALO'",
    _TREE + "tree.interface.new_socket('x', socket_type='NodeSocketGeometry')",
    "bpy.context.scene.view_settings.look = 'AgX - High Contrast'",
    "try:\n    import bgl\nexcept ImportError:\n    bgl = None",
    "if bpy.app.version < (3, 5, 0):\n    import bgl",
    "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import bgl",
    _OBJECT + "ob.driver_add('location', -1)[0].driver",
    _OBJECT + "place = -1\nob.driver_add('location', place)[0].driver",
    _POINTS + "if 'Density Max' in points.inputs:\n    points.inputs['Density Max'].default_value = 1",
    _POINTS + "try:\n    points.inputs['Density Max'].default_value = 1\nexcept KeyError:\n    pass",
    _OBJECT + "try:\n    ob.field.type = 'WIND'\nexcept AttributeError:\n    pass",
    _OBJECT + "print(ob.field.type if ob.field else '')",
    _TREE + "menu = tree.nodes.new('GeometryNodeMenuSwitch')\nmenu.enum_items.new('C')\n"
    "menu.inputs['Menu'].default_value = 'C'",
    _FLUID + "fluid.fluid_type = 'DOMAIN'\nfluid.domain_settings.domain_type = 'LIQUID'",
    _FLUID
    + "kind = 'FLOW'\nfluid.fluid_type = kind\nsettings = fluid.flow_settings\nsettings.flow_type = 'SMOKE'",
    _FLUID + "if fluid.domain_settings:\n    fluid.domain_settings.domain_type = 'LIQUID'",
    _FLUID + "settings = fluid.domain_settings\nif settings:\n    settings.domain_type = 'LIQUID'",
    _FLUID + "same = fluid\nsame.fluid_type = 'DOMAIN'\nfluid.domain_settings.domain_type = 'LIQUID'",
    _FLUID
    + "fluid.fluid_type = 'FLOW'\nfluid.fluid_type = 'DOMAIN'\nfluid.domain_settings.domain_type = 'LIQUID'",
    _FLUID + "bpy.context.object.modifiers['Fluid'].fluid_type = 'DOMAIN'\n"
    "fluid.domain_settings.domain_type = 'LIQUID'",
    _PAINT + "bpy.ops.dpaint.type_toggle(type='CANVAS')\nbpy.ops.dpaint.type_toggle(type='BRUSH')\n"
    "paint.brush_settings.paint_color = (1, 0, 0)",
    _STRIP + "strip.channelbag(slot, ensure=True).fcurves.new('location')",
    _STRIP + "strip.channelbags.new(slot)\nstrip.channelbag(slot).fcurves.new('location')",
    _STRIP + "bag = strip.channelbag(slot)\nif bag:\n    bag.fcurves.new('location')",
    _OBJECT + "ob.keyframe_insert('location')\nob.animation_data.action.name",
    _OBJECT + "ob.driver_add('location', 0)\nob.animation_data.drivers[0].driver",
    _CUBE + "bpy.ops.rigidbody.object_add()\nbpy.context.object.rigid_body.mass = 2",
    _CUBE + "bpy.ops.rigidbody.objects_add(type='ACTIVE')\nbpy.context.object.rigid_body.mass = 2",
    _CUBE + "getattr(bpy.ops.object, 'force' + 'field_toggle')()\nbpy.context.object.field.type = 'WIND'",
    _CUBE + "bpy.context.object.modifiers.new('x', 'COLLISION')\nbpy.context.object.collision.damping = 1",
    "bpy.ops.object.effector_add(type='WIND')\nbpy.context.object.field.strength = 3",
    _POINTS + "points.distribute_method = 'POISSON'\npoints.inputs['Density Max'].default_value = 3",
    _POINTS + "points.inputs[3].default_value = 3",
    _POINTS + "points.inputs['Density'].default_value = 3",
    _ZONE + "second = tree.nodes.new('GeometryNodeSimulationOutput')\nfirst.pair_with_output(second)\n"
    "tree.links.new(first.outputs['Geometry'], second.inputs['Geometry'])",
    _ZONE + "first.outputs['Delta Time']",
    _GLARE + "glare.inputs['Type'].default_value = 'Fog Glow'",
    _TREE + "tree.interface.new_socket('x', socket_type='NodeSocketGeometry')",
    _OBJECT + "ob.driver_add('location', 2).driver",
    _OBJECT + "ob.driver_add('location')[0].driver",
    _OBJECT + "ob.driver_add('hide_render').driver",
    _OBJECT + "for curve in ob.driver_add('rotation_euler'):\n    curve.driver.expression = '1'",
    _ACTION + "ob.animation_data.action_slot = action.slots.new('OBJECT', 'x')",
    _ARMATURE + "bpy.context.collection.objects.link(ob)\nbpy.context.view_layer.objects.active = ob\n"
    "bpy.ops.object.mode_set(mode='EDIT')\narmature.edit_bones.new('x')\nbpy.ops.object.mode_set(mode='OBJECT')",
    _DRIVER + "variable.targets[0].id = ob",
    _DRIVER + "target = variable.targets[0]\ntarget.id_type = 'SCENE'\ntarget.id = bpy.context.scene",
]


def run_each(folder: Path, codes: list[str]) -> list[list[str]]:
    """What became of each code, each run in a file of its own."""
    emptied = "import bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)"
    return run_statements(folder, [line for code in codes for line in (emptied, code)])[1::2]


@pytest.fixture(scope="module")
def errors(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What each code fails with in Blender, or nothing; all of them are run by one."""
    codes = [f"import bpy\n{code}" for code in (*chain.from_iterable(WRONG.values()), *RIGHT)]
    answers = run_each(tmp_path_factory.mktemp("new-things"), codes)
    return {code: error for code, (error, *_) in zip(codes, answers, strict=True)}


@pytest.mark.parametrize("rule", WRONG)
def test_what_blender_refuses_is_found(check: Check, errors: dict[str, str], rule: str) -> None:
    codes = [f"import bpy\n{code}" for code in WRONG[rule]]
    assert [code for code in codes if not errors[code]] == []
    assert [code for code in codes if len(check(rule, code)) != 1] == []


def test_what_blender_takes_is_no_finding(rule_checker: Checker, errors: dict[str, str]) -> None:
    codes = [f"import bpy\n{code}" for code in RIGHT]
    assert [(code, errors[code]) for code in codes if errors[code]] == []
    assert [code for code in codes if rule_checker.check(code, rules=list(WRONG))] == []


def test_what_property_groups_lack_is_lost_in_older_blenders_without_an_error(
    rule_checker: Checker, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = "import bpy\nsettings = bpy.data.lights.new('x', 'POINT').cycles\nsettings.cast_shadow = True\n"
    assert [one.severity for one in rule_checker.check(code, rules=["unknown-attribute"])] == ["error"]
    monkeypatch.setattr(rule_checker, "version", (4, 5, 15))
    assert [one.severity for one in rule_checker.check(code, rules=["unknown-attribute"])] == ["warning"]


def test_an_input_by_its_name_changes_nothing(check: Check, tmp_path: Path) -> None:
    made = (
        f"import bpy\n{_TREE}item = tree.interface.new_socket('Size', in_out='INPUT', socket_type='NodeSocketFloat')\n"
        f"{_CUBE}modifier = bpy.context.object.modifiers.new('x', 'NODES')\nmodifier.node_group = tree\n"
    )
    lines = [
        made + "modifier['Size'] = 5.0",
        made + "modifier[item.identifier] = 5.0",
        made + "modifier['other'] = 5.0",
    ]
    answers = run_statements(tmp_path, lines, dict.fromkeys(range(len(lines)), "modifier[item.identifier]"))
    assert [(error, after) for error, _, after in answers] == [("", "0.0"), ("", "5.0"), ("", "0.0")]
    assert [len(check("input-by-name", line)) for line in lines] == [1, 0, 0]


@pytest.mark.parametrize("rule", ["hidden-socket", "not-in-edit-mode"])
@pytest.mark.parametrize(
    "elsewhere", ["import rigs\nrigs.prepare()", "from .rigs import prepare", "setattr(x, y, 1)"]
)
def test_what_may_be_done_elsewhere_is_no_finding(check: Check, rule: str, elsewhere: str) -> None:
    assert [code for code in WRONG[rule] if check(rule, f"import bpy\n{elsewhere}\n{code}")] == []


def test_what_a_node_never_shows_is_found_whatever_is_done_elsewhere(check: Check, tmp_path: Path) -> None:
    code = f"import bpy\n{_BACKGROUND}shader.inputs['Weight'].default_value = 1"
    assert "KeyError" in run_statements(tmp_path, [code])[0][0]
    assert [
        len(check("hidden-socket", f"{before}\n{code}")) for before in ("", "import rigs\nrigs.prepare()")
    ] == [1, 1]


def test_grease_pencil_of_before_is_no_data_of_objects_beside_the_newer_one(
    rule_checker: Checker, check: Check, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = "import bpy\nbpy.data.objects.new('x', bpy.data.grease_pencils.new('x'))"
    assert not check("wrong-type", code)
    is_class = rule_checker.api.is_class

    def in_4_5(path: str) -> bool:
        return path == "bpy.types.GreasePencilv3" or is_class(path)

    monkeypatch.setattr(rule_checker.api, "is_class", in_4_5)
    (found,) = check("wrong-type", code)
    assert "`bpy.data.grease_pencils_v3` makes" in found.message


_MADE_BELOW = "scene = bpy.data.scenes.new('x')\n"
_READ = "scene.compositing_node_group.nodes.new('NodeReroute')"


@pytest.mark.parametrize(
    ("before", "between", "count"),
    [
        ("import rigs", "", 1),
        ("try:\n    import rigs\nexcept ImportError:\n    rigs = None\nrigs.prepare()", "", 1),
        ("from .rigs import prepare\nprepare()", "scene.name = str(1)\nprint(scene.name)", 1),
        ("import rigs", "rigs.prepare()", 0),
        ("import rigs", "import others", 0),
        ("import rigs", "rigs.prepare(scene)", 0),
        ("import rigs\nsetattr(x, y, 1)", "", 0),
    ],
)
def test_a_thing_that_is_made_below_what_others_do_is_new(
    check: Check, before: str, between: str, count: int
) -> None:
    assert len(check("empty-pointer", f"import bpy\n{before}\n{_MADE_BELOW}{between}\n{_READ}")) == count


def test_what_is_made_elsewhere_is_no_new_thing(check: Check) -> None:
    assert not check("empty-pointer", f"import bpy\nimport rigs\nscene = rigs.scene()\n{_READ}")
