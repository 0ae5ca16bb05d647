"""A declaration of a property that Blender refuses.

`bpy.props` looks at its arguments when the class is registered, or the property assigned to one: what does not fit
ends that with an error.

```python
bpy.props.IntProperty(default=1.5)  # reported: an int
bpy.props.EnumProperty(items=[("A", "First")])  # reported: ("A", "First", "")
bpy.props.EnumProperty(items=[("A", "First", "")], default="B")  # reported: none of the items
bpy.props.FloatVectorProperty(size=4, default=(1, 1, 1))  # reported: 3 values for 4
bpy.props.IntProperty(update=lambda self: None)  # reported: it gets (self, context)
bpy.props.PointerProperty(type=bpy.types.Node)  # reported: neither a data-block nor a group of properties
bpy.types.Object.color = bpy.props.FloatProperty()  # reported: objects have one of that name
```

A default beyond the property's own range is a warning: Blender keeps it until somebody sets the property.

Not reported: items that are computed, and functions that are not defined in the script.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import ClassObject
from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import RUNTIME
from kb_build.symbols.records import RNA_TYPES
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import calls
from kb_check.findings import Finding, Fix
from kb_check.registered.classes import plain_classes
from kb_check.rule import Rule
from kb_check.syntax.literals import functions, number, set_of, times_bound, written
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kb_check.findings import Severity
    from kb_check.script import Script

_PROPS = "bpy.props."
# What Blender calls each function with, besides the one that gives an enumeration's items.
_CALLED_WITH = {
    "update": ("self", "context"), "get": ("self",), "set": ("self", "value"), "poll": ("self", "object"),
    "search": ("self", "context", "edit_text"), "get_transform": ("self", "value", "is_set"),
    "set_transform": ("self", "new_value", "value", "is_set"), "items": ("self", "context"),
}  # fmt: skip
_NUMBERS = ("default", "min", "max", "soft_min", "soft_max", "step", "precision", "maxlen")
_INTS = frozenset({"precision", "maxlen"})
_OF_INTS = frozenset({"IntProperty", "IntVectorProperty"})
_LONGEST_VECTOR = 32
_USUAL_VECTOR = 3
_FLAG = "ENUM_FLAG"
_FORMS = "(identifier, name, description), with a number or an icon and a number behind them"
_BUILTIN = frozenset(
    {"int", "float", "str", "bool", "list", "dict", "tuple", "set", "object", "bytes", "type"}
)


_NEEDED = {"EnumProperty": ("items",), "PointerProperty": ("type",), "CollectionProperty": ("type",)}
_SETS = frozenset({"options", "override", "tags"})
_NO_SETS = (ast.List, ast.Tuple, ast.Dict, ast.Constant)


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        path = call.callee.symbol.path
        if not path.startswith(_PROPS) or call.has_unpacking:
            continue
        given = {parameter.name: node for parameter, node in call.arguments()}
        one = _Declaration(script, call.node, path, given)
        yield from one.general()
        yield from one.functions()
        yield from one.numbers()
        match path.removeprefix(_PROPS):
            case "EnumProperty":
                yield from one.enumeration()
            case "BoolProperty":
                yield from one.truth()
            case "PointerProperty" | "CollectionProperty":
                yield from one.target()
            case "IntVectorProperty" | "FloatVectorProperty" | "BoolVectorProperty":
                yield from one.vector()
            case _:
                pass
    for node in script.all(ast.Assign):
        if isinstance(node.value, ast.Call) and callee_path(script, node.value).startswith(_PROPS):
            yield from _taken_names(script, node.targets)


def _taken_names(script: Script, targets: Sequence[ast.expr]) -> Iterator[Finding]:
    """Properties that a class of data-blocks has itself; what it inherits, and what Python gives it, may be covered."""
    for target in targets:
        kind = script.type_of(target.value) if isinstance(target, ast.Attribute) else None
        if not isinstance(target, ast.Attribute) or not isinstance(kind, ClassObject):
            continue
        if not script.api.descends(kind.cls, ID):
            continue
        symbol = script.api.symbols.symbol(f"{kind.cls}.{target.attr}")
        if symbol and symbol.type in RNA_TYPES and RUNTIME not in symbol.flags:
            told = (
                f"`{symbol.path}` is Blender's own: it refuses another property of that name. Choose another."
            )
            yield Finding(RULE.id, "error", script.name_span(target), told, symbol.path)


class _Declaration:
    """One call of ``bpy.props``, by the names of its arguments."""

    def __init__(self, script: Script, call: ast.Call, path: str, given: Mapping[str, ast.expr]) -> None:
        self._script = script
        self._call = call
        self._path = path
        self._name = path.removeprefix(_PROPS)
        self._given = given

    def general(self) -> Iterator[Finding]:
        """What is left out though it must be there, None where none can be given, and lists for sets."""
        for name in _NEEDED.get(self._name, ()):
            if name not in self._given:
                yield self._finding(self._call, name, "must be given")
        for name, node in self._given.items():
            value = written(self._script, node)
            is_none = isinstance(value, ast.Constant) and value.value is None
            may_be_none = name in _CALLED_WITH or (name == "default" and self._name == "EnumProperty")
            if is_none and (not may_be_none or name == "items"):
                yield self._finding(node, name, "cannot be None")
            elif name in _SETS and isinstance(node, _NO_SETS):
                fix = set_of(self._script, node) if isinstance(node, ast.Constant) else None
                yield self._finding(node, name, "takes a set", fix=fix)

    def functions(self) -> Iterator[Finding]:
        """Functions that take other arguments than those that Blender calls them with. ``*args`` does not count."""
        for name, wants in _CALLED_WITH.items():
            node = self._given.get(name)
            arguments = self._arguments(node)
            if isinstance(node, ast.Constant) and node.value is not None:
                yield self._finding(node, name, f"takes a function, not {node.value!r}")
            if node is None or arguments is None:
                continue
            count = len(arguments.posonlyargs) + len(arguments.args)
            if count != len(wants):
                has = counted(count, "argument")
                yield self._finding(
                    node, name, f"is called with `({', '.join(wants)})`, and this function has {has}"
                )

    def _arguments(self, node: ast.expr | None) -> ast.arguments | None:
        if isinstance(node, ast.Lambda):
            return node.args
        function = functions(self._script).get(node.id) if isinstance(node, ast.Name) else None
        return function.args if function and not function.decorator_list else None

    def numbers(self) -> Iterator[Finding]:
        """Floats for ints, and a default beyond the range."""
        values = {name: number(self._script, self._given[name]) for name in _NUMBERS if name in self._given}
        for name, value in values.items():
            wants_int = name in _INTS or (self._name in _OF_INTS)
            if wants_int and isinstance(value, float):
                yield self._finding(self._given[name], name, f"takes an int, not {value}")
                return
        default, low, high = (values.get(name) for name in ("default", "min", "max"))
        if low is not None and high is not None and low > high:
            yield self._finding(self._given["min"], "min", f"is beyond max, which is {high}", "warning")
        elif default is not None and (
            (low is not None and default < low) or (high is not None and default > high)
        ):
            limit = f"min={low}" if low is not None and default < low else f"max={high}"
            yield self._finding(
                self._given["default"], "default",
                f"is beyond {limit}, and Blender keeps it until the property is set", "warning",
            )  # fmt: skip

    def truth(self) -> Iterator[Finding]:
        """A default that is neither True nor False, 1 nor 0."""
        node = self._given.get("default")
        value = written(self._script, node) if node else None
        is_wrong = isinstance(value, ast.Constant) and value.value is not None and not _is_truth(value.value)
        if node is not None and isinstance(value, ast.Constant) and is_wrong:
            yield self._finding(node, "default", f"takes True or False, not {value.value!r}")

    def target(self) -> Iterator[Finding]:
        """What a pointer or a collection cannot be of."""
        node = self._given.get("type")
        if node is None:
            return
        is_pointer = self._name == "PointerProperty"
        bases = (ID, f"{T}PropertyGroup") if is_pointer else (f"{T}PropertyGroup",)
        kind, api = self._script.type_of(node), self._script.api
        what = ""
        if isinstance(node, ast.Constant):
            what = repr(node.value) if node.value is not None else ""
        elif isinstance(node, ast.Name) and node.id in _BUILTIN and not isinstance(kind, ClassObject):
            what = "" if times_bound(self._script)[node.id] else f"`{node.id}`"
        elif isinstance(node, ast.Name) and node.id in plain_classes(self._script):
            what = f"`{node.id}`, which derives from none"
        elif isinstance(kind, ClassObject) and not any(api.descends(kind.cls, base) for base in bases):
            row = self._script.analysis.resolutions.get(node)
            what = f"`{kind.cls}`" if row is None or not row.missing else ""  # another rule tells of that
        if what:
            takes = "a class of data-blocks or a PropertyGroup" if is_pointer else "a PropertyGroup"
            yield self._finding(node, "type", f"takes {takes}, not {what}")

    def vector(self) -> Iterator[Finding]:
        """A size that is too large, and a default of another one."""
        node = self._given.get("size")
        size = number(self._script, node) if node else _USUAL_VECTOR
        if (
            node is not None
            and size is not None
            and not (isinstance(size, int) and 1 <= size <= _LONGEST_VECTOR)
        ):
            yield self._finding(node, "size", f"takes an int from 1 to {_LONGEST_VECTOR}, not {size}")
            return
        default = self._given.get("default")
        value = written(self._script, default) if default else None
        if default is None or size is None:
            return
        if isinstance(value, (ast.Tuple, ast.List)) and not any(
            isinstance(n, ast.Starred) for n in value.elts
        ):
            if len(value.elts) != size:
                yield self._finding(default, "default", f"takes {size} values, not {len(value.elts)}")
        elif isinstance(value, ast.Constant) and value.value is not None:
            yield self._finding(default, "default", f"takes {size} values, not {value.value!r}")

    def enumeration(self) -> Iterator[Finding]:
        """Items of another form, and a default that is none of them."""
        items, default = self._given.get("items"), self._given.get("default")
        if items is None:
            return
        if self._arguments(items) is not None:
            value = written(self._script, default) if default else None
            is_int = isinstance(value, ast.Constant) and (value.value is None or isinstance(value.value, int))
            if default is not None and isinstance(value, (ast.Constant, ast.Set)) and not is_int:
                yield self._finding(default, "default", "takes an int only where a function gives the items")
            return
        names: set[str] | None = set()
        shown = written(self._script, items)
        if not isinstance(shown, (ast.Tuple, ast.List)):
            return
        for item in shown.elts:
            if _is_wrong_item(item):
                yield self._finding(item, "items", f"takes {_FORMS}")
                return
            first = item.elts[0] if isinstance(item, ast.Tuple) and item.elts else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                names = names if names is None else {*names, first.value}
            elif not (isinstance(item, ast.Constant) and item.value is None):
                names = None
        if default is not None and names is not None:
            yield from self._default(default, names)

    def _default(self, node: ast.expr, names: set[str]) -> Iterator[Finding]:
        options = self._given.get("options")
        if options is not None and not isinstance(options, ast.Set):
            return
        parts = options.elts if isinstance(options, ast.Set) else []
        if not all(isinstance(part, ast.Constant) for part in parts):
            return
        has_flags = any(isinstance(part, ast.Constant) and part.value == _FLAG for part in parts)
        value = written(self._script, node)
        listed = ", ".join(repr(name) for name in sorted(names)[:8])
        if isinstance(value, ast.Set):
            given = [part.value for part in value.elts if isinstance(part, ast.Constant)]
            unknown = [name for name in given if name not in names]
            if not has_flags:
                yield self._finding(node, "default", f"takes a set only with options={{{_FLAG!r}}}")
            elif unknown:
                yield self._finding(
                    node, "default", f"has {unknown[0]!r}, which is none of the items: {listed}"
                )
        elif isinstance(value, ast.Constant) and isinstance(value.value, str):
            if has_flags:
                yield self._finding(node, "default", f"takes a set with options={{{_FLAG!r}}}")
            elif value.value not in names:
                yield self._finding(node, "default", f"is none of the items: {listed}")

    def _finding(
        self, node: ast.expr, name: str, what: str, severity: Severity = "error", fix: Fix | None = None
    ) -> Finding:
        path = f"{self._path}({name})"
        return Finding(RULE.id, severity, self._script.span(node), f"`{path}` {what}.", path, (), fix)


def _is_truth(value: object) -> bool:
    return isinstance(value, int) and value in {0, 1}


def _is_wrong_item(item: ast.expr) -> bool:
    """Whether an item of an enumeration surely has none of the forms that Blender takes."""
    if isinstance(item, ast.Constant):
        return item.value is not None  # None is a line between items
    if isinstance(item, (ast.List, ast.Set, ast.Dict, ast.JoinedStr)):
        return True
    if not isinstance(item, ast.Tuple) or any(isinstance(part, ast.Starred) for part in item.elts):
        return False
    kinds = [type(part.value) if isinstance(part, ast.Constant) else None for part in item.elts]
    if not 3 <= len(kinds) <= 5 or any(kind not in {str, None} for kind in kinds[:3]):
        return True
    icon, numbers = (kinds[3:4], kinds[4:]) if len(kinds) == 5 else ([], kinds[3:])
    return any(kind not in {str, int, None} for kind in icon) or any(
        kind not in {int, None} for kind in numbers
    )


RULE = Rule("refused-property", "error", "A declaration of a property that Blender refuses", _check)
