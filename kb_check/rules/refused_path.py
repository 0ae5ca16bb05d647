"""A path to animate or to drive that Blender refuses.

``keyframe_insert``, ``keyframe_delete`` and ``driver_add`` take the path of a property of the very data-block that they
are called on. Items of an array are told by ``index``, which counts within it, and keys stand in double quotes.

```python
obj.keyframe_insert("location.x")  # reported: keyframe_insert("location", index=0)
obj.keyframe_insert("location", index=3)  # reported: 0 to 2
obj.keyframe_insert("hide_render", index=0)  # reported: one value, which has no index
obj.keyframe_insert("name")  # reported: no animatable property
image.keyframe_insert("alpha_mode")  # reported: images have no animation data
curve.keyframe_insert("mute")  # reported: what an Action holds takes no key
lamp.keyframe_insert("data.energy")  # reported: lamp.data.keyframe_insert("energy")
obj.driver_add('modifiers["Array"].number')  # reported: no modifier has it
obj.keyframe_insert("modifiers['Array'].count")  # reported: double quotes
scatter.keyframe_insert(
    '["Socket_2"]'
)  # reported since 5.2: scatter.properties.inputs.Socket_2.keyframe_insert("value")
```

Not reported: paths that a script puts together, but for those to inputs of geometry nodes, what stands in a ``try``,
names that the script asks for (``hasattr(modifier, "number")``), and ``driver_remove``, which takes paths that lead
nowhere.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import ID, OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import ANIMATABLE
from kb_build.symbols.paths import last_name
from kb_check.calls.sites import calls
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.literals import number, written
from kb_check.values.data_paths import follow, item, size
from kb_serve.recognise.chains.subscripts import INPUT_KEY, NODES_MODIFIER, CustomProperties
from kb_serve.recognise.changed_by import ANIMATED_BY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script
    from kb_check.values.data_paths import Followed

_DRIVING = f"{T}bpy_struct.driver_add"  # it takes no keywords
_CALLS = frozenset({f"{T}bpy_struct.keyframe_insert", f"{T}bpy_struct.keyframe_delete", _DRIVING})
_UNBRACKETED = (ast.Name, ast.Attribute, ast.Subscript, ast.Call)  # a dot may stand behind these as they are
_KEPT_IN = "animation_data"
_MODIFIER = f"{T}Modifier"
# What Blender computes from another property when it is read, and turns into that when it is set.
_PUT_IN = "\0"  # stands for what is put into a text
_ALL = -1  # the index that stands for every item


class _Fault(NamedTuple):
    message: str
    symbol: str
    instead: tuple[str, ...] = ()
    fix: Fix | None = None


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        path = call.callee.symbol.path
        if path not in _CALLS or call.has_unpacking or not isinstance(call.node.func, ast.Attribute):
            continue
        given = {parameter.name: node for parameter, node in call.arguments()}
        node, index = given.get("path" if path == _DRIVING else "data_path"), given.get("index")
        if node is None or is_tried(script, call.node):
            continue
        fault = _of_text(script, call, node, index)
        if fault is None and index is not None:
            fault, node = _of_index(script, call, node, index), index
        if fault is not None:
            yield Finding(RULE.id, "error", script.span(node), *fault)


def _of_text(script: Script, call: CallSite, node: ast.expr, index: ast.expr | None) -> _Fault | None:
    """What is wrong with a path, whatever the index."""
    if isinstance(node, (ast.Tuple, ast.List)):
        return _Fault(
            f"`{call.callee.symbol.name}` takes one path: call it for each.", call.callee.symbol.path
        )
    if fault := _of_input(script, call, node):
        return fault
    followed = _followed(script, call, node)
    if followed is None:
        return None
    return (
        _elsewhere(script, call, followed, node)
        or _of_item(script, call, followed, node, index)
        or _of_end(script, followed, _text(script, node))
    )


def _followed(script: Script, call: CallSite, node: ast.expr) -> Followed | None:
    text = written(script, node)
    if not isinstance(text, ast.Constant) or not isinstance(text.value, str):
        return None
    if not text.value or not isinstance(call.node.func, ast.Attribute):
        return None
    return follow(script, call.node.func.value, text.value)


def _of_input(script: Script, call: CallSite, node: ast.expr) -> _Fault | None:
    """A path to an input of geometry nodes as a custom property of the modifier, where the inputs are properties.

    What is put into a path that is put together stands for a key.
    """
    text = _filled(node) if isinstance(node, ast.JoinedStr) else _text(script, node)
    if '["' not in text or not isinstance(call.node.func, ast.Attribute):
        return None
    followed = follow(script, call.node.func.value, text)
    are_modifiers = bool(followed.keyed) and all(
        script.api.descends(cls, _MODIFIER) for cls in followed.keyed
    )
    if not are_modifiers or not CustomProperties(script.names.reader).inputs_are_properties:
        return None
    before = text.removesuffix(followed.rest)
    key = INPUT_KEY.fullmatch(followed.rest.removeprefix('["').removesuffix('"]'))
    place = f"properties.inputs.{key[1] if key else 'Socket_2'}"
    told = f"the path is `{before.replace(_PUT_IN, '…')}.{place}.value`"
    if not before:  # what is no data-block takes paths to what it has itself alone
        modifier = ast.unparse(call.node.func.value)
        told = f'call `{modifier}.{place}.{call.callee.symbol.name}("value")`'
    return _Fault(
        "Inputs of a geometry-nodes modifier are no custom properties since Blender 5.2: "
        f"{told}{'' if key else ', with the identifier of the input'}.", NODES_MODIFIER, (),
        _at_input(script, call, node, before, place) if key and not key[2] else None,
    )  # fmt: skip


def _at_input(script: Script, call: CallSite, node: ast.expr, before: str, place: str) -> Fix | None:
    """``'modifiers["Array"]["Socket_2"]'`` → ``'modifiers["Array"].properties.inputs.Socket_2.value'``."""
    if not before:
        return _moved(script, call, node, place, "value")
    quote, now = _quote(script, node), f"{before}.{place}.value"
    edit = Edit(script.span(node), f"{quote}{now}{quote}")
    return Fix("Write the property", (edit,), sure=True) if quote and quote not in now else None


def _filled(node: ast.JoinedStr) -> str:
    return "".join(str(part.value) if isinstance(part, ast.Constant) else _PUT_IN for part in node.values)


def _elsewhere(script: Script, call: CallSite, followed: Followed, node: ast.expr) -> _Fault | None:
    """A path into another data-block, or one that leads nowhere."""
    symbol, path = call.callee.symbol, _text(script, node)
    if followed.crossing:
        before, behind = path[: followed.crossing], path[followed.crossing :].removeprefix(".")
        return _Fault(
            f"`{before}` is another data-block, which has animation data of its own: call `{symbol.name}` on that, "
            f"with {behind!r}.", symbol.path, (), _moved(script, call, node, before, behind),
        )  # fmt: skip
    if followed.misquoted:
        return _Fault(
            "Keys in a path stand in double quotes: Blender finds nothing by others.", symbol.path, (),
            _requoted(script, node),
        )  # fmt: skip
    # Of a name alone unknown-attribute tells.
    if followed.lacking and not path.isidentifier() and not _is_asked_for(script, followed.name):
        lacking = script.names.member(followed.lacking[0], followed.name)
        return _Fault(lacking.message, lacking.symbol, lacking.instead)
    return None


def _is_asked_for(script: Script, name: str) -> bool:
    """Whether a name stands in the script as a text of its own, as in ``hasattr(ob, "name")``."""
    return name in _texts(script)


@once_per_script
def _texts(script: Script) -> frozenset[str]:
    return frozenset(node.value for node in script.all(ast.Constant) if isinstance(node.value, str))


def _of_item(
    script: Script, call: CallSite, followed: Followed, node: ast.expr, index: ast.expr | None
) -> _Fault | None:
    """A path that names an item of an array, or something behind a value."""
    path = _text(script, node)
    if not followed.properties or not followed.rest:
        return None
    whole, first = path.removesuffix(followed.rest), followed.properties[0]
    places = {item(symbol, followed.rest) for symbol in followed.properties}
    place = places.pop() if len(places) == 1 else None
    if place is None:
        return _Fault(f"`{first.path}` has no `{followed.rest}`.", first.path)
    how = f"{call.callee.symbol.name}({whole!r}, {_index_text(call, place)})"
    return _Fault(
        f"`{path}` is an item of an array, which a path here does not name: give its index, `{how}`.",
        first.path, (), _indexed(script, call, node, whole, place) if index is None else None,
    )  # fmt: skip


def _of_end(script: Script, followed: Followed, path: str) -> _Fault | None:
    """A path to what cannot be animated. By its own path a data-block takes keys on the curves of its drivers, which
    these refuse themselves.
    """
    if path.startswith(f"{_KEPT_IN}.drivers[") or not followed.properties:
        return None
    if any(ANIMATABLE in symbol.flags for symbol in followed.properties):
        return None
    first = followed.properties[0]
    if first.kind == "function":
        return _Fault(f"`{first.path}` is a function, and no property.", first.path)
    return _Fault(f"`{first.path}` cannot be animated.{_instead(script, first)}", first.path)


def _instead(script: Script, symbol: Symbol) -> str:
    """Why nothing of such a data-block can be; what moves an object where a matrix or the size of its box is meant."""
    owner = symbol.owner
    if owner != ID and script.api.descends(owner, ID) and script.api.member(owner, _KEPT_IN) is None:
        return f" A `{owner}` has no animation data."
    if owner == OBJECT and symbol.name.startswith("matrix_"):
        return " Animate `location`, `rotation_euler` and `scale`."
    other = ANIMATED_BY.get(symbol.path)
    computed = "" if owner == OBJECT else ", from which Blender computes it"
    return f" Animate `{other}`{computed}." if other else ""


def _of_index(script: Script, call: CallSite, node: ast.expr, given: ast.expr) -> _Fault | None:
    """What is wrong with an index of what a path leads to."""
    index, followed = number(script, given), _followed(script, call, node)
    if isinstance(index, float):
        return _Fault(f"An index is an int, not {index}.", call.callee.symbol.path)
    sizes = [size(symbol) for symbol in followed.properties] if followed else []
    if index is None or index == _ALL or followed is None or not sizes or None in sizes:
        return None
    if any(length and 0 <= index < length for length in sizes):
        return None
    symbol = max(followed.properties, key=lambda one: size(one) or 0)
    if count := size(symbol):
        return _Fault(f"`{symbol.path}` has {count} values: there is no index {index}.", symbol.path)
    return _Fault(f"`{symbol.path}` is one value, which has no index.", symbol.path)


def _text(script: Script, node: ast.expr) -> str:
    text = written(script, node)
    return text.value if isinstance(text, ast.Constant) and isinstance(text.value, str) else ""


# Edits.


def _quote(script: Script, node: ast.expr) -> str:
    """The quote of a literal that is written plainly; empty for what is not."""
    text = script.text(script.span(node))
    plain = isinstance(node, ast.Constant) and isinstance(node.value, str) and text[1:-1] == node.value
    return text[0] if plain and text[0] in "\"'" else ""


def _indexed(script: Script, call: CallSite, node: ast.expr, whole: str, place: int) -> Fix | None:
    """``"location.x"`` → ``"location", index=0``."""
    quote = _quote(script, node)
    if not quote or len(call.node.args) > 1:
        return None
    text = f"{quote}{whole}{quote}, {_index_text(call, place)}"
    return Fix("Give the index", (Edit(script.span(node), text),), sure=True)


def _index_text(call: CallSite, index: int) -> str:
    return f"{index}" if call.callee.symbol.path == _DRIVING else f"index={index}"


def _moved(script: Script, call: CallSite, node: ast.expr, before: str, behind: str) -> Fix | None:
    """``lamp.keyframe_insert("data.energy")`` → ``lamp.data.keyframe_insert("energy")``."""
    quote = _quote(script, node)
    function = call.node.func
    if not quote or not isinstance(function, ast.Attribute) or not isinstance(function.value, _UNBRACKETED):
        return None
    edits = (
        Edit.behind(script.span(function.value), f".{before}"),
        Edit(script.span(node), f"{quote}{behind}{quote}"),
    )
    return Fix(f"Call it on {last_name(before)}", edits, sure=True)


def _requoted(script: Script, node: ast.expr) -> Fix | None:
    """``"modifiers['Array'].count"`` → ``'modifiers["Array"].count'``."""
    path = _text(script, node)
    if not _quote(script, node) or '"' in path or "\\" in path:
        return None
    text = path.replace("'", '"')
    return Fix("Write double quotes", (Edit(script.span(node), f"'{text}'"),), sure=True)


RULE = Rule("refused-path", "error", "A path to animate that Blender refuses", _check)
