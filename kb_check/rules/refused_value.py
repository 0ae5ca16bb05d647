"""A value that an enumeration has, but refuses as things stand.

Some values are taken only while another setting has the right one, or only by things of some kind.

```python
settings = scene.render.image_settings
settings.file_format = "FFMPEG"  # reported since 5.0: settings.media_type = 'VIDEO' comes first
tree = bpy.data.node_groups.new("Tree", "CompositorNodeTree")
tree.interface.new_socket(
    "Mesh", socket_type="NodeSocketGeometry"
)  # reported: geometry node trees have it only
compare = tree.nodes.new("FunctionNodeCompare")
compare.data_type = "BOOLEAN"  # reported: RNA lists it for other nodes
mix = material.node_tree.nodes.new("ShaderNodeMix")
mix.data_type = "ROTATION"  # reported: geometry node trees have it only
bpy.ops.rigidbody.mass_calculate(
    material="DEFAULT"
)  # reported: RNA lists it in the place of values made later
```

What a script sets before decides. Where it names the other setting nowhere, or only in later statements of the same
body, what a new scene has does, which a file that is open may have otherwise: that is a warning.

Not reported: what follows calls that may change the other setting out of sight, and add-ons.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import words
from kb_build.symbols.api_names import ID, NODE, OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.flags import usual_default
from kb_build.symbols.paths import last_name
from kb_build.symbols.taken import NEVER, Setting
from kb_check.calls.resolved import called_operators, callee_path, member_path
from kb_check.calls.sites import calls_not_ready_for
from kb_check.findings import Finding, Fix
from kb_check.nodes.trees import is_refused_in, tree_of
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.raised import REFUSES_ENUM
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import is_new
from kb_check.scene.opening import OPENING
from kb_check.scene.settings_before import made_just_before, set_before
from kb_check.script import once_per_script
from kb_check.syntax.bindings import alias, bindings
from kb_check.syntax.named_before import is_named_only_behind
from kb_check.syntax.words import named_words
from kb_serve.recognise.likely.likely_values import same_elsewhere

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kb_build.flow.values.types import Resolution
    from kb_build.symbols.records import EnumItem, NewValue, Parameter, Symbol
    from kb_check.findings import Severity
    from kb_check.script import Script

_OF = re.compile(r"(.+) of an? (\w+)")
_SCENE = f"{T}Scene"
_TOLD = 4
_RESETTING = "bpy.ops.wm.read_factory_settings"


class _Setting(NamedTuple):
    """A setting beside a property, ``of``, and the values with which an item of that is taken."""

    of: str
    symbol: Symbol
    values: frozenset[str]
    is_taken: bool

    def refuses(self, value: object) -> bool:
        return (value in self.values) != self.is_taken


def _check(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("store"):
        node, statement = row.node, row.statement
        if (
            not _is_certain(row)
            or not isinstance(node, ast.Attribute)
            or not isinstance(statement, ast.Assign)
        ):
            continue
        symbol = script.api.symbols.symbol(row.symbols[0])
        item = _item(symbol.enum_items, statement.value) if symbol else None
        if symbol is None or item is None or len(statement.targets) > 1:
            continue
        if setting := _setting(script, symbol, item):
            yield from _refused_by_setting(script, statement, node, setting, item)
        elif item.where and item.where.beside:
            yield from _refused_beside(script, statement, node, symbol.owner, item)
        elif not item.is_taken and script.api.descends(symbol.owner, NODE):
            yield _never_taken(script, statement.value, item, symbol)
        elif is_refused_in(tree := tree_of(script, node.value), item):
            yield _finding(script, statement.value, item, symbol.path, f"this node is in a {tree}")
        elif kind := _other_kind(script, node.value, item):
            yield _finding(script, statement.value, item, symbol.path, f"this is a {kind}")
    yield from _given_to_calls(script)


def _given_to_calls(script: Script) -> Iterator[Finding]:
    """Values that functions and operators are given."""
    for call in calls_not_ready_for(script, REFUSES_ENUM):
        function = call.node.func
        if isinstance(function, ast.Attribute) and call.callee.symbol.kind == "function":
            for parameter, given in call.arguments():
                item = _item(parameter.enum_items, given)
                if item and (kind := _other_kind(script, function.value, item)):
                    yield _finding(script, given, item, call.callee.symbol.path, f"this is a {kind}")
        elif call.callee.symbol.kind == "operator" and not is_tried(script, call.node):
            for parameter, given in call.arguments():
                if parameter.has_stand_in and _item(parameter.enum_items, given):
                    yield _stand_in(script, given, call.callee.symbol.path, parameter)


def _is_certain(row: Resolution) -> bool:
    return (
        row.sure
        and not row.is_ready_for(*REFUSES_ENUM)
        and not row.missing
        and not row.possible
        and len(row.symbols) == 1
    )


def _item(items: Iterable[EnumItem], value: ast.expr) -> EnumItem | None:
    """The item that a literal names, if it is not taken everywhere."""
    text = value.value if isinstance(value, ast.Constant) else None
    return next((item for item in items if item.where and item.identifier == text), None)


def _finding(script: Script, node: ast.expr, item: EnumItem, path: str, why: str) -> Finding:
    where = item.where._replace(there=None) if item.where else NEVER
    article = "a " if where.how == "only" else ""
    taken = where.said(lambda things: article + " or a ".join(things))
    return Finding(RULE.id, "error", script.span(node), f"{item.identifier!r} is {taken}, and {why}.", path)


def _never_taken(script: Script, node: ast.expr, item: EnumItem, symbol: Symbol) -> Finding:
    """What RNA lists for nodes of several classes, and those of this one refuse in every tree."""
    taken = ", ".join(f"`{one.identifier}`" for one in symbol.enum_items if one.is_taken)
    return Finding(
        RULE.id, "error", script.span(node),
        f"{item.identifier!r} is refused by every `{symbol.owner}`. It takes {taken}.", symbol.path,
    )  # fmt: skip


def _stand_in(script: Script, node: ast.expr, operator: str, parameter: Parameter) -> Finding:
    """What RNA lists for an argument whose values are put together while Blender runs."""
    asked = [f"`{value}`" for value in parameter.values_asked]
    takes = (
        f" In a new file it takes {', '.join(asked[:_TOLD])}{' …' if len(asked) > _TOLD else ''}."
        if asked
        else ""
    )
    return Finding(
        RULE.id, "error", script.span(node),
        f"{ast.unparse(node)} stands for nothing in `{operator}({parameter.name})`, which refuses it: leave it out, or "
        f"give one of the values that there are at that time.{takes}",
        operator,
    )  # fmt: skip


# Other settings.


def _setting(script: Script, symbol: Symbol, item: EnumItem) -> _Setting | None:
    """The setting of the same thing that decides whether it takes an item."""
    where = item.where
    if where is None:
        return None
    if setting := where.deciding_setting:
        other = script.api.symbols.symbol(f"{symbol.owner}.{setting.name}")
        more = where.beside.mode if where.beside else Setting(setting.name, ())
        if other is None or (where.beside and (more.name != setting.name or where.how == "not")):
            return None
        return _Setting(symbol.path, other, frozenset(setting.values + more.values), where.how == "only")
    other = script.api.symbols.symbol(f"{symbol.owner}.type")
    if not where.deciding_things or other is None or READ_ONLY in other.flags:
        return None
    owner = script.api.symbols.symbol(symbol.owner)
    what = owner.label.lower().split() if owner else []
    values = [_value_of_kind(other, kind, what) for kind in where.deciding_things]
    return _Setting(symbol.path, other, frozenset(values), where.how == "only") if all(values) else None


def _value_of_kind(kinds: Symbol, label: str, what: list[str]) -> str:
    """The value that makes what is called so: ``VORTEX`` of a vortex force field; empty for none.

    ``what`` are the words that may end the label.
    """
    if label.rpartition(" ")[2] not in what:
        return ""
    for item in kinds.enum_items:
        if label.startswith((f"{item.name.lower()} ", f"{item.identifier.lower()} ")):
            return item.identifier
    return ""


def _refused_by_setting(
    script: Script, statement: ast.Assign, target: ast.Attribute, setting: _Setting, item: EnumItem
) -> Iterator[Finding]:
    name = setting.symbol.name
    if before := set_before(script, statement, target.value, setting.symbol):
        if isinstance(before, ast.Constant) and setting.refuses(before.value):
            found = _finding(script, statement.value, item, setting.of, f"`{name}` is {before.value!r} here")
            others = _taken_with(script, setting, item, before.value)
            yield replace(found, message=f"{found.message}{others}")
    elif told := _as_it_is_new(script, statement, target, setting):
        why, severity = told
        found = replace(_finding(script, statement.value, item, setting.of, why), severity=severity)
        yield _set_first(script, statement, target, setting, found)


def _taken_with(script: Script, setting: _Setting, item: EnumItem, value: object) -> str:
    """A sentence on the items of the same name that are taken with what a setting is; empty for none."""
    symbol = script.api.symbols.symbol(setting.of)
    items = {one.identifier: one for one in symbol.enum_items} if symbol else {}
    found = [
        other
        for other in same_elsewhere(item.identifier, items)
        if symbol and (condition := _setting(script, symbol, items[other])) and not condition.refuses(value)
    ]
    return f" Write {' or '.join(map(repr, found))}." if found else ""


def _as_it_is_new(
    script: Script, statement: ast.Assign, target: ast.Attribute, setting: _Setting
) -> tuple[str, Severity] | None:
    """What a setting is that nothing has set, in words, where a value is refused with that; and how sure it is."""
    name = setting.symbol.name
    if (own := _own_value(script, statement, target.value, setting.symbol)) is not None:
        told = "nothing sets it before" if name in named_words(script) else "this script does not set it"
        return (f"`{name}` of a new one is {own!r}: {told}", "error") if setting.refuses(own) else None
    if (told := _told_unset(script, name, statement)) is None:
        return None
    if owner := _new_owner(script, target.value, setting.symbol):
        why = f"`{name}` of a new {' or '.join(owner.made)} is {owner.value!r}: {told}"
        return (why, "error") if setting.refuses(owner.value) else None
    is_refused = all(map(setting.refuses, _values_of_scene(script, setting.symbol)))
    if is_refused and _works_on_a_scene(script, target.value):
        return f"in a new scene `{name}` is {usual_default(setting.symbol)!r}: {told}", "warning"
    return None


def _set_first(
    script: Script, statement: ast.Assign, target: ast.Attribute, setting: _Setting, found: Finding
) -> Finding:
    """A finding where nothing sets a setting, with the fix that does, where one value alone will do."""
    owner, name = script.text(script.span(target.value)), setting.symbol.name
    is_plain = setting.is_taken and len(setting.values) == 1 and not set("(\n") & set(owner)
    if not is_plain or name in named_words(script):
        return found
    edit = script.line_before(statement, f"{owner}.{name} = {next(iter(setting.values))!r}")
    if edit is None:
        return found
    fix = Fix(f"Set {name} first", (edit,), sure=True)
    return replace(found, instead=(setting.symbol.path,), fix=fix)


def _told_unset(script: Script, name: str, statement: ast.stmt) -> str | None:
    """That a setting has not been set when a script comes to a statement; None where it may have been."""
    if name not in named_words(script):
        return "this script does not set it"
    return "this script does not set it before" if is_named_only_behind(script, name, statement) else None


def _refused_beside(
    script: Script, statement: ast.Assign, target: ast.Attribute, owner: str, item: EnumItem
) -> Iterator[Finding]:
    """A value that goes with what the script has set only if a struct beside has another setting than a new one has."""
    condition = item.where.beside if item.where else None
    if condition is None:
        return
    mode, needed = condition
    setting, beside = (
        script.api.symbols.symbol(path) for path in (f"{owner}.{mode.name}", f"{T}{needed.name}")
    )
    before = set_before(script, statement, target.value, setting) if setting else None
    if (
        beside
        and isinstance(before, ast.Constant)
        and before.value in mode.values
        and beside.name not in named_words(script)
        and not set(_values_of_scene(script, beside)) & set(needed.values)
        and _works_on_a_scene(script, target.value)
    ):
        why = f"`{mode.name}` is {before.value!r} here, and in a new scene `{beside.name}` is {usual_default(beside)!r}"
        yield replace(
            _finding(script, statement.value, item, f"{owner}.{mode.name}", why), severity="warning"
        )


def _own_value(script: Script, statement: ast.stmt, node: ast.expr, setting: Symbol) -> object:
    """What a setting is on what the script has made, where it is not set: on what a name stands for, or on the data of
    the object that an operator has just made; None where that is not known.
    """
    cls = script.class_of(node)
    symbol = script.api.symbols.symbol(cls) if cls else None
    if symbol is None or not knows_all(script):
        return None
    label = symbol.label.lower()
    maker = made_just_before(script, statement, node, setting)
    if maker.startswith(OPERATORS):
        made = f"{label} by {maker.removeprefix(OPERATORS)}("
        ways = [new for new in setting.new_values if not new.when and any(map(_begins(made), new.made))]
        usual = [new for new in setting.new_values if not new.when and not new.made]
        return next((new.value for new in (*ways, *usual)), usual_default(setting))
    if not maker and (setting.name in named_words(script) or not _is_new_name(script, node)):
        return None
    values = [new.value for new in setting.new_values if not new.when and (label in new.made or not new.made)]
    own = [new.value for new in setting.new_values if not new.when and label in new.made]
    return (own or values or [usual_default(setting)])[0]


def _is_new_name(script: Script, node: ast.expr) -> bool:
    """Whether a name stands for nothing but what the script's calls have made."""
    return (
        isinstance(node, ast.Name)
        and is_new(script, node)
        and all(isinstance(value, ast.Call) for value in bindings(script).get(node.id, []))
    )


def _begins(text: str) -> Callable[[str], bool]:
    return lambda longer: longer.startswith(text)


def _new_owner(script: Script, node: ast.expr, setting: Symbol) -> NewValue | None:
    """What a setting is on what the script made, where that is of a class whose new ones have a value of their own."""
    if not knows_all(script):
        return None
    node = alias(script, node)
    while isinstance(node, ast.Attribute) and (path := member_path(script, node)):
        symbol = script.api.symbols.symbol(path)
        if symbol is None or symbol.type != "pointer":
            break
        node = alias(script, node.value)
        cls = script.class_of(node)
        for new in setting.new_values:
            is_of = any(script.api.is_class(f"{T}{made}") and cls == f"{T}{made}" for made in new.made)
            if is_of and not new.when and is_new(script, node):
                return new
    return None


def _values_of_scene(script: Script, symbol: Symbol) -> list[object]:
    """What a setting may be in a new scene: not what it is where it belongs to something of another class."""
    new_values = (
        new.value
        for new in symbol.new_values
        if not (new.when and new.when.partition("=")[0] not in named_words(script))
        and not any(script.api.is_class(f"{T}{made}") for made in new.made)
    )
    return [usual_default(symbol), *new_values]


def _works_on_a_scene(script: Script, node: ast.expr) -> bool:
    """Whether a script that is run by itself, with nothing hidden, sets something of a scene."""
    if (
        _is_add_on(script)
        or not knows_all(script)
        or called_operators(script) & OPENING
        or _takes_template(script)
    ):
        return False
    node = alias(script, node)
    while isinstance(node, ast.Attribute):
        row = script.analysis.resolutions.get(node)
        symbol = script.api.symbols.symbol(row.symbols[0]) if row and len(row.symbols) == 1 else None
        if (
            symbol is None
            or symbol.type != "pointer"
            or script.api.descends(f"bpy.types.{symbol.target}", ID)
        ):
            break
        node = alias(script, node.value)
    return script.class_of(node) == _SCENE


@once_per_script
def _is_add_on(script: Script) -> bool:
    return any(isinstance(part, ast.FunctionDef) and part.name == "register" for part in script.tree.body)


@once_per_script
def _takes_template(script: Script) -> bool:
    """Whether the script may read the settings of an application template, which has its own."""
    calls_of_it = [node for node in script.all(ast.Call) if callee_path(script, node) == _RESETTING]
    return any(keyword.arg != "use_empty" for call in calls_of_it for keyword in call.keywords)


# Kinds of things.


def _other_kind(script: Script, node: ast.expr, item: EnumItem) -> str:
    """The kind of something, or of what it belongs to, that does not take an item; empty where none is known."""
    kinds = set(item.where.deciding_things) if item.where else set[str]()
    is_only = item.where is not None and item.where.how == "only"
    if is_only and (other := _of_another(script, node, kinds)):
        return other
    while kinds:
        node = alias(script, node)
        cls = script.class_of(node)
        symbol = script.api.symbols.symbol(cls) if cls else None
        if not is_only and any(script.api.descends(cls, f"{T}{kind}") for kind in kinds):
            return last_name(cls)
        if symbol and symbol.base and kinds <= _labels_below(script, symbol.base):
            label = symbol.label.lower()
            is_refused = (label in kinds) != is_only
            # It may be one of those kinds: a node tree may be that of a geometry.
            is_open = is_refused and not kinds.isdisjoint(_labels_below(script, cls))
            return label if is_refused and not is_open else ""
        if not isinstance(node, ast.Attribute):
            break
        node = node.value
    return ""


def _of_another(script: Script, node: ast.expr, kinds: set[str]) -> str:
    """What something is that was made for another thing: a constraint of an object, not of a bone; or empty."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    makers = {callee_path(script, value) if isinstance(value, ast.Call) else "" for value in values}
    cls = script.class_of(node)
    for ancestor in script.api.lineage(cls) if cls and len(kinds) == 1 else ():
        symbol = script.api.symbols.symbol(ancestor)
        found = _OF.fullmatch(next(iter(kinds)))
        if symbol is None or found is None or symbol.label.lower() != found[1]:
            continue
        holders = {maker.removeprefix(T).removesuffix(f"{last_name(ancestor)}s.new") for maker in makers}
        is_other = holders and all(
            script.api.is_class(f"{T}{one}") and found[2] not in words(one) for one in holders
        )
        return f"{found[1]} of an {holders.pop().lower()}" if is_other and len(holders) == 1 else ""
    return ""


def _labels_below(script: Script, base: str) -> set[str]:
    below = (script.api.symbols.symbol(path) for path in script.api.descendants(base))
    return {symbol.label.lower() for symbol in below if symbol}


RULE = Rule("refused-value", "error", "A value that is refused as things stand", _check)
