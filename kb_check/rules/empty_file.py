"""Something is read from what an empty file does not have, and nothing in the script makes it.

```python
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.world.color = (0, 0, 0)  # reported: scene.world = bpy.data.worlds.new("World") fills it
bpy.data.objects["Cube"].hide_render = True  # reported: that of the startup file is gone
```

Not reported: what may run before the file is emptied; scripts that fill it anywhere, that run operators which may, that
compute names or import modules which may change scenes; what the script asks for (``if scene.world:``), and what stands
in a ``try``.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.emptied import empties_only, is_emptied_before
from kb_check.findings import Finding
from kb_check.made_here import (
    asked_names,
    calls_only,
    keywords_and_texts,
    knows_all,
    member_path,
    named_words,
    read_pointer,
    stored_names,
    texts_but_keys,
)
from kb_check.rule import Rule
from kb_check.script import once_for_each
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.types import Resolution
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

    ``asked`` are names that ask for it besides its own.
    """

    beside: re.Pattern[str]
    filled_by: str
    asked: frozenset[str] = frozenset()


_ACTIVE = _Empty(
    re.compile(_PLAIN), "view_layer.objects.active = obj", frozenset({"active", "object", "active_object"})
)
_EMPTY = {
    f"{T}Scene.world": _Empty(
        re.compile(f"{_PLAIN}|{_EDITING}"), 'scene.world = bpy.data.worlds.new("World")'
    ),
    f"{T}Scene.camera": _Empty(
        re.compile(rf"(?!bpy\.ops\.object\.\w*(add|camera))({_PLAIN}|{_EDITING})"), "scene.camera = obj"
    ),
    f"{T}Scene.compositing_node_group": _Empty(
        re.compile(rf"(?!bpy\.ops\.node\.new_compositing)({_PLAIN}|{_EDITING})"),
        'scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")',
    ),
    f"{T}LayerObjects.active": _ACTIVE,
    f"{T}Context.object": _ACTIVE,
    f"{T}Context.active_object": _ACTIVE,
}
# What the startup file has that an empty one has not, and the operators that bring nothing of the name.
_STARTUP = {
    "objects": {"Cube", "Camera", "Light"}, "meshes": {"Cube"}, "cameras": {"Camera"}, "lights": {"Light"},
    "materials": {"Material"}, "worlds": {"World"}, "collections": {"Collection"},
}  # fmt: skip
_BRINGING_NOTHING = re.compile(_PLAIN)


def _check(script: Script) -> Iterator[Finding]:
    if empties_only(script) and knows_all(script):
        yield from _pointers(script)
        yield from _looked_up(script)


def _pointers(script: Script) -> Iterator[Finding]:
    reported: set[str] = set()
    for row in script.resolutions("attribute", "store"):
        node = row.node
        pointer = read_pointer(script, node.value) if isinstance(node, ast.Attribute) else None
        path = member_path(script, pointer) if pointer else ""
        if path not in _EMPTY or path in reported or not isinstance(node, ast.Attribute):
            continue
        if _stays_empty(script, path) and _is_run_later(script, row, node):
            reported.add(path)
            yield Finding(
                RULE.id, "warning", script.name_span(node),
                f"`{path}` is None in an empty file, and nothing in this script fills it: "
                f"`{_EMPTY[path].filled_by}` does.",
                path,
            )  # fmt: skip


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
                if row and is_gone and _is_run_later(script, row, node):
                    yield Finding(
                        RULE.id, "warning", script.span(node),
                        f"An empty file has no `bpy.data.{name}[{key!r}]`, and nothing in this script makes one.",
                        path,
                    )  # fmt: skip
            case _:
                pass


def _is_run_later(script: Script, row: Resolution, node: ast.expr) -> bool:
    statement = row.statement
    return statement is not None and not is_tried(script, node) and is_emptied_before(script, statement)


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


RULE = Rule("empty-file", "warning", "Something read from what an empty file lacks", _check)
