"""Whether a script may do something that its text does not show."""

from __future__ import annotations

import ast
import builtins
import sys
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.calls.resolved import callee_path
from kb_check.running.computing import RUNNING, STORING, computing
from kb_check.script import once_per_script
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.bodies import innermost, statement_of

if TYPE_CHECKING:
    from kb_check.script import Script

# Modules that change nothing in Blender's data but what is given to them.
_HARMLESS = (sys.stdlib_module_names - {"runpy", "importlib"}) | {
    "bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "idprop", "bl_math", "blf", "aud", "imbuf", "numpy", "scipy",
    "pandas", "PIL", "cv2", "requests", "yaml", "tqdm", "matplotlib",
}  # fmt: skip
# Of Blender's own helpers, the modules and functions of which the same is true.
_HARMLESS_HELPERS = frozenset(
    {
        "bpy_extras.anim_utils", "bpy_extras.io_utils", "bpy_extras.mesh_utils", "bpy_extras.view3d_utils",
        "bpy_extras.object_utils.world_to_camera_view", "rna_prop_ui",
    }
)  # fmt: skip


@once_per_script
def computes_names(script: Script) -> bool:
    """Whether something out of sight may set settings: computed names, or the files beside the script."""
    is_computed = not computing(script).isdisjoint(RUNNING | STORING)
    return is_computed or any(node.level > 0 for node in script.all(ast.ImportFrom))


@once_per_script
def knows_all(script: Script) -> bool:
    """Whether all that a script does stands in it: it computes no names, and imports nothing that changes scenes."""
    if computes_names(script):
        return False
    imported = {alias.name for node in script.all(ast.Import) for alias in node.names}
    imported |= {f"{node.module}.{alias.name}" for node in script.all(ast.ImportFrom) for alias in node.names}
    return all(name.partition(".")[0] in _HARMLESS or _is_helper(name) for name in imported)


def is_untouched(script: Script, node: ast.expr, place: ast.expr) -> bool:
    """Whether nothing out of sight runs between the making of a new thing and a place further down in the same body.

    ``node`` is the thing, or what belongs to it.
    """
    if not computing(script).isdisjoint(RUNNING | STORING):
        return False
    while isinstance(node, ast.Attribute):
        node = node.value
    made = once_bound(script, node)
    if not isinstance(made, ast.Call) or not callee_path(script, made).endswith(".new"):
        return False
    body, first = innermost(script, made)
    last = statement_of(body, place)
    between = [part for statement in body[first : last + 1] for part in walk(statement)]
    return first <= last and not any(_is_foreign(script, part) for part in between)


def _is_foreign(script: Script, node: ast.AST) -> bool:
    """Whether what a part of a script runs may stand elsewhere."""
    if isinstance(node, ast.Call) and not callee_path(script, node):
        return not isinstance(node.func, ast.Name) or not hasattr(builtins, node.func.id)
    return isinstance(node, (ast.Import, ast.ImportFrom))


def _is_helper(name: str) -> bool:
    """Whether a dotted name is one of the harmless helpers, or in one."""
    return name in _HARMLESS_HELPERS or name.rpartition(".")[0] in _HARMLESS_HELPERS
