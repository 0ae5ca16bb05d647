# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one script in a fresh Blender and writes down how it ended and what the scene then holds.

``main`` takes the script, or the folder of an add-on, and the file to write the facts to, as JSON.
"""

import importlib
import json
import os
import sys
import traceback

import bpy

_DIGITS = 4
_ENGINES = {"BLENDER_EEVEE_NEXT": "BLENDER_EEVEE"}  # one engine, which had another name for a while


def main(arguments):
    """Runs ``arguments[0]`` and writes the facts to ``arguments[1]``."""
    script, out = arguments
    facts = {"blender": list(bpy.app.version), "error": _run(script)}
    facts["scene"] = scene_facts()
    with open(out, "w", encoding="utf-8") as file:
        json.dump(facts, file)
    # Some Blenders never end where classes are left registered, and there is nothing left to do.
    os._exit(0)


def _run(script):
    """Runs a script; None, or the error that ended it, with the line of the script that it arose from."""
    try:
        if os.path.isdir(script):
            _register(script)
        else:
            with open(script, "rb") as file:
                code = compile(file.read(), script, "exec")
            sys.argv = [script]
            exec(code, {"__name__": "__main__", "__file__": script})  # noqa: S102 - the script is the user's, and asked for
    except SystemExit as end:
        return _described(end, script) if end.code else None
    except BaseException as error:
        return _described(error, script)
    return None


def _register(folder):
    """Registers the add-on in a folder, as Blender does when it is enabled, and takes it off again."""
    import addon_utils  # found once bpy was imported

    above, name = os.path.split(os.path.abspath(folder))
    # Blender's own add-on of that name may be enabled: it makes room.
    addon_utils.disable(name)
    for module in [module for module in sys.modules if module == name or module.startswith(name + ".")]:
        del sys.modules[module]
    sys.path.insert(0, above)
    bpy.context.preferences.addons.new().module = name  # its own preferences, which it may ask for
    module = importlib.import_module(name)
    module.register()
    module.unregister()


def _described(error, script):
    steps = traceback.extract_tb(error.__traceback__)
    own = [step for step in steps if step.filename.startswith(script)]
    return {
        "kind": type(error).__name__,
        "message": str(error)[:500],
        "file": os.path.relpath(own[-1].filename, os.path.dirname(script)) if own else "",
        "line": own[-1].lineno if own else getattr(error, "lineno", 0) or 0,
    }


def scene_facts():
    """What the scene holds, in words and numbers that mean the same in every version."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    return {
        "engine": _ENGINES.get(scene.render.engine, scene.render.engine),
        "frames": [scene.frame_start, scene.frame_end, scene.frame_current],
        "size": [scene.render.resolution_x, scene.render.resolution_y],
        "active": bpy.context.view_layer.objects.active.name if bpy.context.view_layer.objects.active else "",
        "camera": scene.camera.name if scene.camera else "",
        "objects": {obj.name: _object_facts(obj) for obj in scene.objects},
        "collections": {
            collection.name: sorted(obj.name for obj in collection.objects)
            for collection in bpy.data.collections
        },
        "materials": {
            material.name: _tree_facts(material.node_tree, _rounded(material.diffuse_color))
            for material in bpy.data.materials
            if not material.is_grease_pencil
        },
        "groups": {group.name: _tree_facts(group) for group in bpy.data.node_groups},
    }


def _object_facts(obj):
    facts = {
        "type": obj.type,
        "data": obj.data.name if obj.data else "",
        "place": [_rounded(row) for row in obj.matrix_world],
        "parent": obj.parent.name if obj.parent else "",
        "selected": obj.select_get() if obj.name in bpy.context.view_layer.objects else False,
        "modifiers": [[modifier.name, modifier.type] for modifier in obj.modifiers],
        "constraints": [[constraint.name, constraint.type] for constraint in obj.constraints],
        "materials": [slot.material.name if slot.material else "" for slot in obj.material_slots],
        "animation": _animation(obj),
    }
    if obj.type == "MESH":
        mesh = obj.data
        facts["mesh"] = [len(mesh.vertices), len(mesh.edges), len(mesh.polygons), len(mesh.uv_layers)]
        # Not the object's dimensions: versions measure what a modifier makes differently.
        corners = [[vertex.co[axis] for vertex in mesh.vertices] or [0.0] for axis in range(3)]
        facts["size"] = _rounded([max(places) - min(places) for places in corners])
    elif obj.type == "LIGHT":
        facts["light"] = [obj.data.type, _rounded([obj.data.energy])[0]]
    elif obj.type == "CAMERA":
        facts["lens"] = _rounded([obj.data.lens])[0]
    return facts


def _animation(obj):
    """(data path, index, number of keys) of each F-curve that moves an object."""
    data = obj.animation_data
    if data is None or data.action is None:
        return []
    action = data.action
    if hasattr(action, "fcurves"):
        curves = action.fcurves
    else:
        bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
        curves = [curve for bag in bags for curve in bag.fcurves]
    return sorted([curve.data_path, curve.array_index, len(curve.keyframe_points)] for curve in curves)


def _tree_facts(tree, *more):
    nodes = sorted(node.bl_idname for node in tree.nodes) if tree else []
    return [len(nodes), len(tree.links) if tree else 0, *more]


def _rounded(numbers):
    return [round(number, _DIGITS) + 0.0 for number in numbers]
