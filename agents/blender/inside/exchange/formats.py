# SPDX-License-Identifier: GPL-3.0-or-later
"""Formats that other programs read and write: which operators of this Blender do it, and with which settings."""

import contextlib
import os
import re

import addon_utils
import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.file_io import reason

_MODULES = {
    "import_scene.gltf": "io_scene_gltf2",
    "export_scene.gltf": "io_scene_gltf2",
    "import_scene.fbx": "io_scene_fbx",
    "export_scene.fbx": "io_scene_fbx",
    "import_mesh.stl": "io_mesh_stl",
    "export_mesh.stl": "io_mesh_stl",
}
_EXCEPTION = re.compile(r"[\w.]+(Error|Exception|Exit)\b")  # how the last line of a traceback begins
# Format → operators that read it, the first that is there counts. Settings that an operator lacks are left out.
_IMPORTERS = {
    "gltf": {
        "import_scene.gltf": {
            "import_pack_images": True,
            "import_scene_as_collection": False,
            "disable_bone_shape": True,
        }
    },
    "usd": {
        "wm.usd_import": {
            "import_textures_mode": "IMPORT_PACK",
            "set_frame_range": False,
            "create_world_material": False,
        }
    },
    "abc": {"wm.alembic_import": {"set_frame_range": False, "relative_path": False}},
    "fbx": {"wm.fbx_import": {}, "import_scene.fbx": {}},
    "obj": {"wm.obj_import": {"validate_meshes": True}, "import_scene.obj": {}},
    "stl": {"wm.stl_import": {"use_mesh_validate": True}, "import_mesh.stl": {}},
}
_EXPORTERS = {
    "gltf": {"export_scene.gltf": {"use_selection": True, "export_cameras": True, "export_lights": True}},
    "usd": {
        "wm.usd_export": {
            "selected_objects_only": True,
            "evaluation_mode": "VIEWPORT",
            "export_textures": True,
            "export_textures_mode": "NEW",
            "overwrite_textures": True,
            "relative_paths": True,
            "convert_world_material": False,
        }
    },
    "abc": {"wm.alembic_export": {"selected": True, "evaluation_mode": "VIEWPORT", "face_sets": True}},
    "fbx": {
        "export_scene.fbx": {
            "use_selection": True,
            "use_mesh_modifiers_render": False,
            "path_mode": "COPY",
            "embed_textures": True,
            "add_leaf_bones": False,
        }
    },
    "obj": {
        "wm.obj_export": {
            "export_selected_objects": True,
            "export_eval_mode": "DAG_EVAL_VIEWPORT",
            "path_mode": "COPY",
            "export_pbr_extensions": True,
        },
        "export_scene.obj": {"use_selection": True, "path_mode": "COPY"},
    },
    "stl": {
        "wm.stl_export": {"export_selected_objects": True},
        "export_mesh.stl": {"use_selection": True},
    },
}


def supported():
    """{format: whether this Blender ("reads", "writes") it}."""
    return {
        name: {
            "reads": _find(_IMPORTERS[name]) is not None,
            "writes": _find(_EXPORTERS[name]) is not None,
        }
        for name in _IMPORTERS
    }


def read(name, path, **settings):
    """Imports a file of the format. Raises Refused."""
    _run(_IMPORTERS, "reads", name, path, settings)


def write(name, path, **settings):
    """Exports the selected objects in the format. Raises Refused."""
    _run(_EXPORTERS, "writes", name, path, {"check_existing": False, **settings})


def _run(table, verb, name, path, settings):
    found = _find(table[name])
    if found is None:
        can = ", ".join(known for known, does in supported().items() if does[verb])
        raise Refused(
            f"This Blender ({bpy.app.version_string}) cannot {verb[:-1]} {name}; its build lacks it. It {verb} {can}."
        )
    operator, own = found
    file = os.path.basename(path)
    known = {setting.identifier for setting in operator.get_rna_type().properties}
    given = {key: value for key, value in {**own, **settings}.items() if key in known and value is not None}
    try:
        ended = operator(filepath=path, **given)
    except RuntimeError as error:
        raise Refused(f"Blender cannot {verb[:-1]} {file} as {name}: {_short(error, path)}") from None
    if "FINISHED" not in ended:
        raise Refused(f"Blender cannot {verb[:-1]} {file} as {name}, and gives no reason; it may be damaged.")


def _find(operators):
    """(operator, settings) of the first one that this Blender has; None if it has none."""
    for full, settings in operators.items():
        group, _, name = full.partition(".")
        operator = getattr(getattr(bpy.ops, group), name)
        if not _exists(operator) and full in _MODULES:
            with contextlib.suppress(Exception):  # whatever an add-on raises, its operator is not there
                addon_utils.enable(_MODULES[full])
        if _exists(operator):
            return operator, settings
    return None


def _exists(operator):
    try:
        operator.get_rna_type()
    except KeyError:
        return False
    return True


def _short(error, path):
    """An operator's message, without the path; of the traceback of an add-on, its exception."""
    lines = [line.strip() for line in reason(error).replace(path, "the file").splitlines() if line.strip()]
    if any("Traceback" in line for line in lines):
        lines = [line for line in lines if _EXCEPTION.match(line)][-1:] or lines[-1:]
    return " ".join(lines)[:400] or "it gave no reason"
