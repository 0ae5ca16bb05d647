"""Something is read from what an empty or a new file does not have, and nothing in the script makes it.

```python
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.world.color = (0, 0, 0)  # reported: scene.world = bpy.data.worlds.new("World") fills it
bpy.data.objects["Cube"].hide_render = True  # reported: that of the startup file is gone
```

Of what a new file has not either, a script that empties none is told, too, as a note: it may be run with another file.

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
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.background import is_called_by_others, lines_of_others
from kb_check.running.out_of_sight import knows_all
from kb_check.running.read_pointers import read_from
from kb_check.running.tried import is_tried
from kb_check.scene.emptied import empties_only, is_emptied_before
from kb_check.script import once_for_each
from kb_check.syntax.words import asked_names, keywords_and_texts, named_words, stored_names, texts_but_keys

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator

    from kb_build.flow.types import Resolution
    from kb_check.findings import Severity
    from kb_check.running.read_pointers import PointerRead
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

    ``asked`` are names that ask for it besides its own; ``is_new`` says that a new file does not have it either.
    """

    beside: re.Pattern[str]
    filled_by: str
    asked: frozenset[str] = frozenset()
    is_new: bool = False


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
        is_new=True,
    ),
    f"{T}Scene.rigidbody_world": _Empty(
        re.compile(rf"(?!bpy\.ops\.rigidbody\.)({_PLAIN}|{_EDITING})"),
        "bpy.ops.rigidbody.world_add()",
        is_new=True,
    ),
    f"{T}LayerObjects.active": _ACTIVE,
    f"{T}Context.object": _ACTIVE,
    f"{T}Context.active_object": _ACTIVE,
}
_NEW = {path: empty for path, empty in _EMPTY.items() if empty.is_new}
# What the startup file has that an empty one has not, and the operators that bring nothing of the name.
_STARTUP = {
    "objects": {"Cube", "Camera", "Light"}, "meshes": {"Cube"}, "cameras": {"Camera"}, "lights": {"Light"},
    "materials": {"Material"}, "worlds": {"World"}, "collections": {"Collection"},
}  # fmt: skip
_BRINGING_NOTHING = re.compile(_PLAIN)


def _check(script: Script) -> Iterator[Finding]:
    if not knows_all(script):
        return
    if empties_only(script):
        read = _first(one for one in _read(script, _EMPTY) if _is_run_later(script, one.row, one.node))
        for path, node in read.items():
            yield _empty_finding(script, node, path, "an empty", "warning")
        yield from _looked_up(script)
    elif not is_called_by_others(script) and "libraries" not in named_words(script):
        given = lines_of_others(script)
        read = _first(one for one in _read(script, _NEW) if one.node.lineno not in given)
        for path, node in read.items():
            yield _empty_finding(script, node, path, "a new", "note")


def _read(script: Script, empty: Container[str]) -> Iterator[PointerRead]:
    """What is read from pointers that the script leaves empty."""
    return (one for one in read_from(script, empty) if _stays_empty(script, one.path))


def _first(found: Iterable[PointerRead]) -> dict[str, ast.Attribute]:
    """Path → where it is read first."""
    first: dict[str, ast.Attribute] = {}
    for one in found:
        first.setdefault(one.path, one.node)
    return first


def _empty_finding(script: Script, node: ast.Attribute, path: str, file: str, severity: Severity) -> Finding:
    told = f"`{path}` is None in {file} file, and nothing in this script fills it: `{_EMPTY[path].filled_by}` does."
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


RULE = Rule("empty-file", "warning", "Something read from what an empty or a new file lacks", _check)
