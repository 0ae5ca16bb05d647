# SPDX-License-Identifier: GPL-3.0-or-later
"""What an honest worker with one cube answers: what lies depart from. ``on_NAME`` takes the arguments of a tool."""

import os
import struct
import zlib


def png(width=16, height=16, value=128, extra=b""):
    """A grey PNG; ``extra``: chunks before its pixels."""
    rows = b"".join(b"\0" + bytes([(value + row) % 256]) * width for row in range(height))
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + extra + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")


def chunk(kind, data):
    """A chunk of a PNG."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def leave(path, data):
    """Writes a file, and gives its number of bytes."""
    with open(path, "wb") as file:
        return file.write(data)


def on_open(arguments):
    return {"objects": 1}


def on_write(arguments):
    return {"seconds": 0.001, "bytes": leave(arguments["path"], b"BLENDER-v501RENDH")}


def on_execute(arguments):
    return {"value": None, "error": None, "changed": {}, "mode": "OBJECT"}


def changed(value, changes):
    """A value with hostile parts. Each change: the way to a part, as numbers of children, and what happens there."""
    for way, act, other in changes:
        value = _changed(value, list(way), act, other)
    return value


def _changed(value, way, act, other):
    if way and isinstance(value, (dict, list)) and value:
        keys = sorted(value) if isinstance(value, dict) else list(range(len(value)))
        key = keys[way[0] % len(keys)]
        if act == "remove" and len(way) == 1:
            del value[key]
        else:
            value[key] = _changed(value[key], way[1:], act, other)
        return value
    if act == "repeat" and isinstance(value, (list, str)):
        return value * other
    if act == "wrap":
        return [value]
    return other


def view(folder, number, name):
    """A view of a preview, and its picture."""
    file = f".preview-{number}.png"
    leave(os.path.join(folder, file), png(32, 32))
    axes = [["X", 1.0, 0.0, 0.0], ["Y", 0.0, 0.0, -1.0], ["Z", 0.0, 1.0, 0.0]]
    return {
        "name": name,
        "file": file,
        "size": [32, 32],
        "metres_per_pixel": 0.1,
        "axes": axes,
        "cut_away": [],
        "labels": [["Cube", 8.0, 8.0]],
        "ground": 20.0,
    }


def on_preview(arguments):
    names = ("front", "right", "top", "three-quarter")
    views = [view(arguments["folder"], number, name) for number, name in enumerate(names)]
    return {
        "title": "Scene",
        "frame": 1,
        "objects": 1,
        "low": [-1.0, -1.0, -1.0],
        "high": [1.0, 1.0, 1.0],
        "views": views,
        "notes": ["a note"],
        "engine": "BLENDER_WORKBENCH",
    }


def on_material_sheet(arguments):
    shown = {**view(arguments["folder"], 0, "three-quarter"), "frame": 1, "key": "0" * 32}
    alone = {"name": "Cube", "file": view(arguments["folder"], 1, "x")["file"], "metres_per_pixel": 0.1}
    alone |= {"key": None, "materials": ["Clay"], "alike": ["Box"], "alike_in_all": 1, "bare": []}
    patch = {
        "name": "Cube",
        "file": view(arguments["folder"], 2, "x")["file"],
        "metres_per_pixel": 0.01,
        "key": None,
    }
    return {"title": "Scene", "scene": [shown], "objects": [alone], "patches": [patch], "notes": ["a note"]}


def on_uv_sheet(arguments):
    files = [view(arguments["folder"], number, "x")["file"] for number in (0, 1)]
    mesh = {
        "name": "Cube",
        "uv_map": "UVMap",
        "maps": 1,
        "faces": 6,
        "missing": False,
        "alike": [],
        "alike_in_all": 0,
    }
    mesh |= {"checker": files[0], "map": files[1], "low": [0.0, 0.0], "high": [1.0, 1.0], "scale": [1.0, 1.0]}
    mesh |= {"outside": 0.0, "stretched": 0.1, "collapsed": 0.0, "mirrored": 0.0, "overlap": 0.2}
    return {"title": "Scene", "meshes": [mesh], "without": ["Bare"], "notes": []}


def on_subject_mask(arguments):
    leave(os.path.join(arguments["folder"], ".preview-0.png"), png(*arguments["size"]))
    return {"file": ".preview-0.png", "subjects": [["Cube", [0, 0, 51]]]}


def on_motion_sheet(arguments):
    os.makedirs(arguments["folder"], exist_ok=True)
    shots = []
    for frame in (1, 2):
        leave(os.path.join(arguments["folder"], f"0-path-{frame}.png"), png(64, 64))
        axes = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
        seen = {"axes": axes, "centre": [0.0, 0.0, 0.0], "metres_per_pixel": 0.1, "size": [64, 64]}
        shots.append({"frame": frame, "view": seen})
    phase = {"phase": "", "start": 1, "end": 2, "present": True, "displacement": 1.0, "path_length": 1.0}
    actor = {
        "name": "Cube",
        "kind": "object",
        "objects": ["Cube"],
        "object_count": 1,
        "measured": "vertices",
        "deforms": False,
        "speed_of": "centre",
        "keyframes": [1, 2],
        "frames": [1, 2],
        "centres": [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        "displacements": [0.0, 1.0],
        "speeds": [None, 24.0],
        "phases": [phase],
        "caches": [],
        "notes": [],
        "columns": 2,
        "views": [{"kind": "path", "pictures": shots}],
    }
    return {
        "start": 1,
        "end": 2,
        "fps": 24.0,
        "stride": 1,
        "sampled": [1, 2],
        "stepped_from": None,
        "stepped_for": [],
        "notes": [],
        "actors": [actor],
    }


def on_render_plan(arguments):
    shot = {
        "engine": "CYCLES",
        "device": "CPU",
        "samples": 1,
        "denoise": False,
        "width": 16,
        "height": 16,
        "camera": "Camera",
        "bound": False,
    }
    return {
        "shot": shot,
        "scene": {"Scene Scene": "0" * 24},
        "unbaked": [],
        "notes": [],
        "current": 1,
        "subframe": 0.0,
        "frame_start": 1,
        "frame_end": 3,
        "fps": 24,
        "fps_base": 1.0,
    }


def on_render_step(arguments):
    return arguments["last"]


def on_render_frame(arguments):
    leave(arguments["path"], png(16, 16, arguments["frame"] * 40))
    return 0.01


def on_render_put_back(arguments):
    return None


def on_render_video(arguments):
    size = leave(arguments["path"], b"a film")
    return {
        "frames": len(arguments["pictures"]),
        "width": arguments["width"],
        "height": arguments["height"],
        "fps": 24.0,
        "bytes": size,
        "seconds": 0.01,
    }


def on_save(arguments):
    size = leave(arguments["path"], b"BLENDER-v501RENDH")
    return {
        "bytes": size,
        "objects": 1,
        "packed": [],
        "rescued": [],
        "unused": [],
        "loose": [],
        "files": [],
        "external": [],
        "caches": [],
    }


def on_inspect(arguments):
    return {"objects": 1, "caches": []}


on_kept_caches = on_inspect


def on_load(arguments):
    return {"objects": 1, "version": "5.1", "scripts": False, "external": [], "caches": []}


def on_exchange_formats(arguments):
    return {"version": "5.1.2", "formats": {"stl": {"reads": True, "writes": True}}}


def exchanged():
    """The facts of one cube with a textured material."""
    image = {"name": "wood", "into": "Base Color", "file": "wood.png", "packed": True, "missing": False}
    return {
        "objects": {"MESH": 1},
        "vertices": 8,
        "triangles": 12,
        "meshes": 1,
        "uv_mapped": 1,
        "low": [-1.0, -1.0, -1.0],
        "high": [1.0, 1.0, 1.0],
        "parented": 0,
        "animated": 1,
        "range": [1, 24],
        "poses": [{"frame": 1, "low": [-1.0, -1.0, -1.0], "high": [1.0, 1.0, 1.0]}],
        "materials": [{"name": "plain", "images": [image]}],
        "missing": [],
    }


def on_import_file(arguments):
    own = {
        "collection": "kept",
        "roots": ["Cube"],
        "outside": [],
        "reads_on": [],
        "notes": ["scaled unevenly"],
    }
    return {**exchanged(), **own}


def on_export_file(arguments):
    os.makedirs(arguments["folder"], exist_ok=True)
    leave(arguments["path"], b"solid\nendsolid\n")
    files = [os.path.relpath(arguments["path"], arguments["folder"])]
    return {**exchanged(), "files": files, "timing": [24, 1.0, 1], "notes": []}


def on_bake(arguments):
    return {"caches": [], "range": [1, 2], "seconds": 0.1, "notes": []}


def on_free_bake(arguments):
    return {"freed": ["cloth of 'Cube'"], "unbaked": []}


def on_trial(arguments):
    os.makedirs(arguments["folder"], exist_ok=True)
    leave(os.path.join(arguments["folder"], "0-1.png"), png(64, 64))
    place = {
        "lowest": 0.0,
        "highest": 1.0,
        "middle": [0.0, 0.0, 0.5],
        "speed": 1.0,
        "velocity": [1.0, 0.0, 0.0],
    }
    sample = {"frame": 1, "alive": None, **place, "volume": 1.0, "depth": 0.1, "inside": "Floor"}
    cube = {
        "name": "Cube",
        "lowest": [0.0, 1],
        "peak_speed": [1.0, 1],
        "most_alive": None,
        "samples": [sample],
    }
    swarm = {**cube, "name": "Rain", "most_alive": 3, "samples": [{**sample, "alive": 3}], "heights": []}
    return {
        "first": 1,
        "last": 2,
        "simulated": True,
        "seconds_per_frame": [0.1, 0.2],
        "whole": [100, 20.0],
        "stopped": "",
        "caches": ["cloth of 'Cube'"],
        "actors": [{**cube, "heights": [[1, 0.0, 1.0, None]]}, swarm],
        "others": {
            "count": 2,
            "moved": {"count": 1, "most": [["Brick", 0.5]]},
            "moving": {"count": 0, "most": []},
        },
        "fallen": ["3 of 3 particles of 'Rain' have gone through 'Floor'."],
        "pictures": [{"of": ["Cube"], "metres_per_pixel": 0.01, "files": {"1": "0-1.png"}}],
        "notes": [],
    }


def on_go_to_frame(arguments):
    return {"scene": "Scene", "frame": 1}


def on_tag(arguments):
    return {"collections": {}, "objects": {"Cube": {}}, "scene": {}, "warnings": []}


def on_scene_facts(arguments):
    return {
        "version": "5.1.2",
        "scene": "Scene",
        "frame": 1,
        "frame_start": 1,
        "frame_end": 3,
        "fps": 24.0,
        "gravity": [0.0, 0.0, -9.81],
        "metres": 1.0,
        "strict_grounding": False,
        "camera": None,
        "world_light": 0.0,
        "collections": [],
        "objects": [],
        "caches": [],
    }


def on_measure(arguments):
    return [{"unmeasured": "nothing is measured"} for _ in arguments["requests"]]


def on_findings_image(arguments):
    views = [{**view(arguments["folder"], 0, "front"), "marks": [None for _ in range(9)]}]
    return {"title": "Scene", "frame": 1, "views": views, "close": [], "notes": []}


def on_scene_state(arguments):
    frame = {"current": 1, "start": 1, "end": 3, "step": 1, "fps": 24}
    scene = {
        "name": "Scene",
        "file": "scene.blend",
        "blender": "5.1.2",
        "frame": frame,
        "units": {"system": "METRIC", "scale_length": 1},
        "gravity": [0, 0, -9.81],
        "engine": "CYCLES",
        "resolution": [16, 16, 100],
        "camera": None,
        "counts": {"MESH": 1},
    }
    return {
        "scene": scene,
        "chosen": 1,
        "unread": {},
        "collections": [{"name": "Scene Collection", "depth": 0, "objects": {"MESH": 1}, "names": ["Cube"]}],
        "objects": [
            {"name": "Cube", "type": "MESH", "in": ["Scene Collection"], "location": [0, 0, 0], "vertices": 8}
        ],
        "physics": [],
        "animation": [],
        "materials": [],
        "view": [],
        "notes": [],
    }
