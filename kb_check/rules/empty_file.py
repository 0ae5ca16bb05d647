"""Something is read from what an empty or a new file does not have, and nothing in the script makes it.

```python
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.world.color = (0, 0, 0)  # reported: scene.world = bpy.data.worlds.new("World") fills it
bpy.data.objects["Cube"].hide_render = True  # reported: that of the startup file is gone
bpy.ops.object.camera_add()
bpy.ops.render.render()  # reported: the scene has no camera before scene.camera = camera
```

Where a script only deletes all objects, their names and the scene's camera are gone.

Of what a new file has not either, a script that empties none is told, too: as a note where it does not read the factory
settings, since it may be run with another file.

```python
bpy.context.scene.compositing_node_group.nodes.clear()  # reported; `use_nodes = True` makes no tree since 5.0
```

Not reported: what may run before the file is emptied; in a file that is not emptied, add-ons and what classes do;
scripts that fill it anywhere, that run operators which may, that compute names or import modules which may change
scenes; what the script asks for (``if scene.world:``), and what stands in a ``try``.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import calls_only, member_path
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.background import is_called_by_others, lines_of_others
from kb_check.running.out_of_sight import knows_all
from kb_check.running.read_pointers import read_from
from kb_check.running.tried import is_tried
from kb_check.scene.emptied import empties_only, is_emptied_before, resets_only
from kb_check.script import once_for_each
from kb_check.syntax.words import asked_names, keywords_and_texts, named_words, stored_names, texts_but_keys

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator

    from kb_build.flow.values.types import Resolution
    from kb_check.findings import Severity
    from kb_check.running.read_pointers import PointerRead
    from kb_check.scene.emptied import What
    from kb_check.script import Script

# Operators that fill none of what is looked for; those that are called read an empty file.
_PLAIN = r"bpy\.ops\.(wm\.(read_factory_settings|read_homefile|save\w*)|(render|export_\w+|screen|preferences)\.\w+)"
_EDITING = (
    r"bpy\.ops\.(mesh|curve|surface|armature|mball|font|lattice|transform|rigidbody|ptcache|fluid|dpaint|cloth|particle|"
    r"material|texture|uv|node|anim|action|graph|nla|pose|constraint|geometry|text|sculpt|paint|object)\.\w+"
)


@dataclass(frozen=True, slots=True)
class _Empty:
    """What an empty file does not have: what may be done beside, and what fills it.

    ``asked`` are names that ask for it besides its own; ``is_new`` says that a new file does not have it either;
    ``what`` is emptied where it is gone.
    """

    beside: re.Pattern[str]
    filled_by: str
    asked: frozenset[str] = frozenset()
    is_new: bool = False
    what: What = "file"


_CAMERA = f"{T}Scene.camera"
_EMPTY = {
    f"{T}Scene.world": _Empty(
        re.compile(f"{_PLAIN}|{_EDITING}"), 'scene.world = bpy.data.worlds.new("World")'
    ),
    _CAMERA: _Empty(
        re.compile(rf"(?!bpy\.ops\.object\.(add|add_named|\w*as_camera)$)({_PLAIN}|{_EDITING})"),
        "scene.camera = obj",
        frozenset({"temp_override"}),  # in a 3D view, an operator that adds a camera gives it to the scene
        what="objects",
    ),
    f"{T}Scene.compositing_node_group": _Empty(
        re.compile(rf"(?!bpy\.ops\.node\.new_compositing)({_PLAIN}|{_EDITING})"),
        'scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")',
        is_new=True,
    ),
    f"{T}Scene.rigidbody_world": _Empty(
        re.compile(rf"(?!bpy\.ops\.rigidbody\.)({_PLAIN}|{_EDITING})"),
        "bpy.ops.rigidbody.world_add()",
        is_new=True,
    ),
}
_NEW = {path: empty for path, empty in _EMPTY.items() if empty.is_new}
# What the startup file has that an empty one has not, and the operators that bring nothing of the name.
_STARTUP = {
    "objects": {"Cube", "Camera", "Light"}, "meshes": {"Cube"}, "cameras": {"Camera"}, "lights": {"Light"},
    "materials": {"Material"}, "worlds": {"World"}, "collections": {"Collection"},
}  # fmt: skip
_OF_OBJECTS = "objects"
_BRINGING_NOTHING = re.compile(
    rf"{_PLAIN}|bpy\.ops\.(object\.(select_all|delete|mode_set|modifier_\w+|shade_\w+|origin_set|transform_apply)|"
    r"transform\.\w+|mesh\.(?!primitive_cube)\w+)"
)
_RENDER = "bpy.ops.render.render"
# What a script names that may render without a camera.
_WITHOUT_CAMERA = re.compile(r"sequence|compositing|^Compositor")


def _check(script: Script) -> Iterator[Finding]:
    if not knows_all(script):
        return
    if empties_only(script, "objects"):
        later = (
            one
            for one in _read(script, _EMPTY)
            if _is_run_later(script, one.row, one.node, _EMPTY[one.path].what)
        )
        for path, node in _first(later).items():
            yield _empty_finding(script, node, path, _emptied(_EMPTY[path].what), "warning")
        yield from _looked_up(script)
        yield from _rendered(script)
    reset: dict[str, ast.Attribute] = {}
    if resets_only(script) and not empties_only(script, "file"):
        read = _read(script, _NEW)
        reset = _first(one for one in read if _is_run_later(script, one.row, one.node, "file"))
        for path, node in reset.items():
            yield _empty_finding(script, node, path, "in a new file", "warning")
    is_others = empties_only(script, "file") or is_called_by_others(script)
    if not is_others and "libraries" not in named_words(script):
        given = lines_of_others(script)
        first = _first(one for one in _read(script, _NEW) if one.node.lineno not in given)
        for path, node in first.items():
            if path not in reset:
                yield _empty_finding(script, node, path, "in a new file", "note")


def _emptied(what: What) -> str:
    return "in an empty file" if what == "file" else "once all objects are gone"


def _read(script: Script, empty: Container[str]) -> Iterator[PointerRead]:
    """What is read from pointers that the script leaves empty."""
    return (one for one in read_from(script, empty) if _stays_empty(script, one.path))


def _first(found: Iterable[PointerRead]) -> dict[str, ast.Attribute]:
    """Path → where it is read first."""
    first: dict[str, ast.Attribute] = {}
    for one in found:
        first.setdefault(one.path, one.node)
    return first


def _empty_finding(script: Script, node: ast.Attribute, path: str, where: str, severity: Severity) -> Finding:
    told = f"`{path}` is None {where}, and nothing in this script fills it: `{_EMPTY[path].filled_by}` does."
    return Finding(RULE.id, severity, script.name_span(node), told, path)


def _looked_up(script: Script) -> Iterator[Finding]:
    """What is looked up in ``bpy.data`` by the name that it has in the startup file."""
    texts = {node.value for node in script.all(ast.Constant) if isinstance(node.value, str)}
    names = texts & set[str]().union(*_STARTUP.values())
    if not names or "libraries" in named_words(script) or not calls_only(script, _BRINGING_NOTHING):
        return
    for node in script.all(ast.Subscript):
        match node:
            case ast.Subscript(
                value=ast.Attribute(attr=name) as collection,
                slice=ast.Constant(value=str(key)),
                ctx=ast.Load(),
            ) if key in _STARTUP.get(name, ()):
                row = script.analysis.resolutions.get(collection)
                path = member_path(script, collection)
                is_gone = path == f"{T}BlendData.{name}" and not _is_named(script, key)
                what: What = "objects" if name == _OF_OBJECTS else "file"
                if row and is_gone and _is_run_later(script, row, node, what):
                    yield Finding(
                        RULE.id, "warning", script.span(node),
                        f"There is no `bpy.data.{name}[{key!r}]` {_emptied(what)}, and nothing in this script makes "
                        "one.",
                        path,
                    )  # fmt: skip
            case _:
                pass


def _rendered(script: Script) -> Iterator[Finding]:
    """Calls that render a scene without a camera."""
    rendering = [call for call in calls(script) if call.callee.symbol.path == _RENDER]
    if not rendering or not _stays_empty(script, _CAMERA):
        return
    if any(map(_WITHOUT_CAMERA.search, named_words(script))):
        return
    for call in rendering:
        row = script.analysis.resolutions.get(call.node)
        if row and call.given.isdisjoint({"scene"}) and _is_run_later(script, row, call.node, "objects"):
            yield Finding(
                RULE.id, "warning", script.span(call.node),
                f"`{_RENDER}` fails without a camera, and nothing in this script gives the scene one: "
                f"`{_EMPTY[_CAMERA].filled_by}` does.",
                _RENDER,
            )  # fmt: skip


def _is_run_later(script: Script, row: Resolution, node: ast.expr, what: What) -> bool:
    statement = row.statement
    return statement is not None and not is_tried(script, node) and is_emptied_before(script, statement, what)


def _stays_empty(script: Script, path: str) -> bool:
    """Whether the script does nothing that may fill it, and does not ask whether it is None."""
    empty = _EMPTY[path]
    names = empty.asked | {path.rpartition(".")[2]}
    return (
        names.isdisjoint(asked_names(script))
        and names.isdisjoint(stored_names(script))
        and names.isdisjoint(keywords_and_texts(script))
        and calls_only(script, empty.beside)
    )


@once_for_each
def _is_named(script: Script, name: str) -> bool:
    """Whether a script has a name for more than to look something up."""
    return any(name in text for text in texts_but_keys(script))


RULE = Rule("empty-file", "warning", "Something read from what an empty or a new file lacks", _check)
