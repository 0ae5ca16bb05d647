"""How a topic's work is done, in order: the calls that make its things, where these go, what is set, what runs it.

Computed from the schema and weights: a class that has a creation call is made; what points to it is where it goes; its
own settings and those it points to are set; the operators of the topic that neither make nor remove anything run it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from operator import itemgetter
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.symbol_lines import held, literal, operator_needs, refused_nothing
from kb_serve.answer.budget import AnswerBlock, tokens
from kb_serve.answer.instances import Instances, filling, stays_empty
from kb_serve.answer.panel_lines import panel_lines
from kb_serve.answer.render import is_machinery
from kb_serve.reader import STRUCT, TYPES

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence

    from kb_build.records import Symbol
    from kb_serve.reader import BaseReader, SymbolEntry

_MOST_TOKENS = 1_150  # of all steps
_MAKERS = 3
_CHOICES = 12  # types that one maker is shown with
_SETTINGS = 10
_HOLDERS = 4  # pointers of a thing whose settings are shown
_FUNCTIONS = 3
_RUNS = 4
_VALUES = 8  # of one argument
_ARGUMENTS = 3  # of an operator's call
_MAKES = ("add", "new", "create", "insert")
_REMOVES = (
    "remove",
    "delete",
    "free",
    "clear",
    "preset",
    "copy",
    "paste",
    "select",
    "move",
    "reset",
    "toggle",
    "hide",
)
_LEAST_SHARE = 0.25  # of the heaviest class's weight
_USED_ELSEWHERE = 3  # weight of an operator that has not the topic's module
_INTERFACE = (
    "tool_settings",
    "space_data",
    "preferences",
    "window",
    "studio_light",
    "region",
    ".area",
    "gizmo",
)
_PLAIN = ("name", "index")  # every thing has them
_CACHE = f"{TYPES}PointCache"
_NODE = f"{TYPES}Node"
_NEW_NAME = re.compile(r'\bnew\("[^"]*"')
# Trees that cannot be assigned: what has one of its own, and the node that ends a new one.
_EMBEDDED = {f"{TYPES}ShaderNodeTree": (f"{TYPES}Material", "node_tree")}
_ENDS = {f"{TYPES}ShaderNodeTree": "tree.get_output_node('ALL')"}
# What the other trees must give to be of use: a socket's name and type.
_GROUP_OUTPUT = {
    f"{TYPES}GeometryNodeTree": ("Geometry", "NodeSocketGeometry"),
    f"{TYPES}CompositorNodeTree": ("Image", "NodeSocketColor"),
}
_NOT_MADE = frozenset({_NODE, *_EMBEDDED})  # for themselves
# Those whose new trees have a node that ends them.
_WITH_OUTPUT = frozenset({f"{TYPES}Material", f"{TYPES}World"})
_USUAL_TREE = f"{TYPES}GeometryNodeTree"
_OBJECT = f"{TYPES}Object"
_OTHERS_ELEMENT = re.compile(r"\[.*\].*\.")  # … of what has an element that somebody else must have made
_PLACES = 4  # that are looked at
_HUMPS = re.compile(r"[A-Z]+[a-z0-9]*")


@dataclass(slots=True)
class TopicNames:
    """The classes and operators of a topic, each with a weight, the heaviest first."""

    keys: frozenset[str]
    words: tuple[frozenset[str], ...]
    classes: dict[str, float] = field(default_factory=dict[str, float])
    operators: dict[str, float] = field(default_factory=dict[str, float])

    def names(self, name: str) -> bool:
        """Whether a name holds the topic's words."""
        return any(words <= set(terms(name)) for words in self.words)


class Steps:
    """The steps of one topic."""

    def __init__(self, reader: BaseReader, names: TopicNames) -> None:
        self._reader = reader
        self._names = names
        self._shown: set[str] = set()
        self._chosen: set[str] = set()
        self._ended: set[str] = set()  # trees that have an output
        self._waiting: list[str] = []  # settings of what a pointer leads to that is None on new things
        self._creations = reader.creations(list(names.classes))
        self._instances = Instances(reader, self)
        # Where classes have the topic's name, the others of its pages are other topics' matter, unless these alone can
        # be made.
        named = [path for path in names.classes if names.names(path)]
        if self._creations and self._creations.keys().isdisjoint(named):
            named = []
        self._classes = named or list(names.classes)

    def blocks(self) -> Iterator[AnswerBlock]:
        """One block, a numbered list; none where nothing is made, set or run."""
        work = (self._make(), self._there()) if self._is_made() else (self._there(), self._make())
        steps = [*self._functions(), *(step for part in work for step in part), *self._run()]
        steps += self._waiting
        lines = [f"{number}. {step}" for number, step in enumerate(steps, 1)]
        while sum(tokens(line) + 1 for line in lines) > _MOST_TOKENS:
            lines.pop()
        if lines:
            yield AnswerBlock("**How it is done**\n" + "\n".join(lines), "how it is done")

    # What is made

    def _is_made(self) -> bool:
        """Whether the topic's main class is made, or held by a modifier that is."""
        return any(path in self._creations for path in self._classes[:1]) or any(
            map(self._is_own_modifier, self._classes)
        )

    def _make(self) -> Iterator[str]:
        groups: dict[str, list[str]] = defaultdict(list)
        # A modifier with the topic's name makes the settings that it holds.
        for path in sorted(self._classes, key=lambda path: not self._is_own_modifier(path)):
            creation = self._creations.get(path)
            if creation and path not in _NOT_MADE and not any(part in creation.call for part in _INTERFACE):
                groups[creation.maker].append(path)
        # The first group is the heaviest class's; of the others, many light classes outweigh a single one.
        first, others = [*groups.values()][:1], [*groups.values()][1:]
        made: list[tuple[bool, list[str]]] = []
        for paths in (*first, *sorted(others, key=lambda paths: -self._weight_of(paths))):
            is_main = self._is_own_modifier(paths[0]) or self._counts(*paths)
            if is_main and paths[0] not in self._shown and len(made) < _MAKERS:
                steps = [*self._make_one(paths, is_first=not made)]
                made.append((not self._needs_nothing(paths[0]), steps))
        # What an operator makes that needs nothing comes first: a world, before what is in it makes one.
        for _, steps in sorted(made, key=itemgetter(0)):
            yield from steps

    def _needs_nothing(self, path: str) -> bool:
        """Whether an operator makes a thing wherever it is called."""
        maker = self._reader.symbol(self._creations[path].maker)
        return maker is not None and refused_nothing(maker) and not operator_needs(maker)

    def _make_one(self, paths: Sequence[str], *, is_first: bool) -> Iterator[str]:
        main = paths[0]
        if self._reader.descends(main, _NODE):
            tree = yield from self._tree(main)
            yield from self._nodes(paths, tree)
            yield from self._calls_on_nodes(paths)
            return
        made = self._call(paths)
        yield from made
        if not made:
            return
        if self._creations[main].call.startswith("bpy.data."):
            yield from self._goes(main)
        if is_first or self._names.names(main):
            yield from self._set(main)
        if is_first:
            yield from self._own_tree(main)

    def _counts(self, *paths: str) -> bool:
        """Whether classes weigh enough, together, beside the topic's heaviest."""
        return self._weight_of(paths) >= _LEAST_SHARE * max(
            map(self._names.classes.__getitem__, self._classes)
        )

    def _weight_of(self, paths: Iterable[str]) -> float:
        return sum(map(self._names.classes.__getitem__, paths))

    def _is_own_modifier(self, path: str) -> bool:
        name = path.removeprefix(TYPES)
        return name.endswith("Modifier") and key(name.removesuffix("Modifier")) in self._names.keys

    def _nodes(self, paths: Sequence[str], tree: str) -> Iterator[str]:
        """How the nodes of a tree are made and joined."""
        yield from self._call(paths)
        node, members = self.variable_of(paths[0]), self._reader.members(paths[0])
        if any(name.startswith("outputs[") for name in members):
            yield from self._end(tree)
            yield f"`tree.links.new({node}.outputs[0], {_ENDS.get(tree, 'group_output')}.inputs[0])`"

    def _calls_on_nodes(self, paths: Iterable[str]) -> Iterator[str]:
        """The functions that nodes themselves have, as those at the ends of zones do."""
        told: set[str] = set()
        for path in paths:
            entries = self._reader.members(path).values()
            functions = [entry for entry in entries if entry.kind == "function" and not is_machinery(entry)]
            if not functions or functions[0].name in told or not self._is_in_tree(path):
                continue
            if path not in self._shown:
                yield from self._call([path])
            partner = path.replace("Input", "Output")
            for entry in functions[:_FUNCTIONS]:
                told.add(entry.name)
                call = _call_of(entry)
                if partner in self._shown:
                    call = call.replace("output_node", self.variable_of(partner))
                yield f"`{self.variable_of(path)}.{call}`"

    def _is_in_tree(self, node: str) -> bool:
        """Whether the tree that was made takes a node."""
        symbol = self._reader.symbol(node)
        return symbol is not None and any(f"{TYPES}{tree}" in self._shown for tree in symbol.trees)

    def _own_tree(self, path: str) -> Iterator[str]:
        """The nodes of what holds a tree, as a material does."""
        for entry in self._reader.members(path).values():
            if entry.type != "pointer" or not entry.target.endswith("NodeTree") or self._is_object_data(path):
                continue
            nodes = self._heaviest(self._reader.descendants(f"{TYPES}{entry.target.removesuffix('Tree')}"))
            self._creations |= self._reader.creations([node.path for node in nodes])
            if made := [node.path for node in nodes if node.path in self._creations]:
                tree, holder = f"{TYPES}{entry.target}", f"{self.variable_of(path)}.{entry.name}"
                self._shown.add(tree)
                is_given = _is_set(entry)  # there is none yet
                if is_given:
                    yield from self._group(tree, holder)
                else:
                    pointer = self._reader.symbol(entry.path)
                    if pointer is None or stays_empty(pointer):
                        continue
                    yield from self._filled(pointer, self.variable_of(path))
                    yield f"`tree = {holder}`"
                is_ended = is_given or path in _WITH_OUTPUT
                yield from self._nodes(made, tree) if is_ended else self._call(made)

    def _call(self, paths: Sequence[str]) -> list[str]:
        """The call that makes the heaviest of the classes that one maker makes, and the types of the others; before it
        the steps that it needs. Nothing where nothing is known to make what it is called on.
        """
        main = paths[0]
        ready = self._instances.call(self._creations[main])
        if ready is None:
            return []
        steps = ready.steps
        if ready.expression.startswith("tree.") and not any(
            path.endswith("NodeTree") for path in self._shown
        ):
            kind = self._creations[main].call.partition("_tree.")[0].capitalize()
            tree = f"{TYPES}{kind}NodeTree"
            steps = [*self._group(tree if self._reader.entry(tree) else _USUAL_TREE), *steps]
        self._instances.add(main, self.variable_of(main))
        text = self._made(main, ready.expression)
        on = ready.expression.partition(".")[0]
        choices = [
            choice
            for path in paths[1:]
            if (choice := self._creations[path].choice) and self._instances.is_on(on, self._creations[path])
        ]
        others = [choice for choice in choices if f"'{choice}'" not in self._creations[main].call]
        if others:
            more = f", … {len(others) - _CHOICES} more" if len(others) > _CHOICES else ""
            text += "; also " + ", ".join(f"`{other}`" for other in others[:_CHOICES]) + more
        return [*steps, text]

    def _made(self, path: str, call: str) -> str:
        self._shown.add(path)
        if call.startswith("bpy.ops."):
            symbol = self._reader.symbol(call.partition("(")[0])
            asked = "; ".join(_asked(symbol, self._reader)) if symbol else ""
            return f"`{call}` → `{path.removeprefix(TYPES)}`" + (f" ({asked})" if asked else "")
        if path == _OBJECT:
            self._instances.add_object("MESH")
            call = 'bpy.data.objects.new("Object", bpy.data.meshes.new("Mesh"))'
        return f"`{self.variable_of(path)} = {call}` → `{path.removeprefix(TYPES)}`"

    def variable_of(self, cls: str) -> str:
        """What a script calls an instance: ``object_data``, or the name's last word; its last two if another is so."""
        if cls == _OBJECT:
            return "obj"
        if self._is_object_data(cls):
            return "object_data"
        *before, last = _HUMPS.findall(cls.removeprefix(TYPES)) or ["it"]
        name = last.lower()
        return "_".join((*map(str.lower, before[-1:]), name)) if self._instances.is_taken(name, cls) else name

    def _tree(self, node: str) -> Generator[str, None, str]:
        """The tree that takes a node; gives its class."""
        symbol = self._reader.symbol(node)
        name = node.removeprefix(TYPES)
        own = sorted(
            symbol.trees if symbol else (), key=lambda t: not name.startswith(t.removesuffix("Tree"))
        )
        tree = f"{TYPES}{own[0]}" if own else ""
        if tree in self._shown:
            return tree
        holder, name = _EMBEDDED.get(tree, ("", ""))
        if made := self._reader.creations([holder]).get(holder):
            self._shown.add(tree)
            yield self._made(holder, made.call)
            if pointer := self._reader.symbol(f"{holder}.{name}"):
                yield from self._filled(pointer, self.variable_of(holder))
            yield f"`tree = {self.variable_of(holder)}.{name}`"
        else:
            yield from self._group(tree)
        return tree

    def _group(self, tree: str, holder: str = "") -> Iterator[str]:
        """A tree that is a data-block of its own. ``holder``: what it becomes the tree of, where that is known."""
        creation = self._reader.creations([tree]).get(tree)
        if creation is None:
            return
        yield self._made(tree, creation.call)
        if holder:
            yield f"`{holder} = {self.variable_of(tree)}`"
        else:
            yield from self._goes(tree)
        yield from self._parts(tree, self.variable_of(tree))

    def _end(self, tree: str) -> Iterator[str]:
        """What gives a group its output."""
        if tree in self._ended or tree in _ENDS:
            return
        self._ended.add(tree)
        name, socket = _GROUP_OUTPUT.get(tree, ("", ""))
        if name:
            yield f"`tree.interface.new_socket(\"{name}\", in_out='OUTPUT', socket_type='{socket}')`"
        yield '`group_output = tree.nodes.new("NodeGroupOutput")`; also `NodeGroupInput`, for its inputs'

    # Where it goes

    def _goes(self, path: str) -> Iterator[str]:
        """Where a new data-block is put so that it counts."""
        variable = self.variable_of(path)
        if variable == "object_data":
            yield from self.object_of(path)
            yield from self._deforming(path)
            variable = "obj"
            places = [place for place in self._named_pointers() if place.target == "Object"]
        elif linked := self._linked(path):
            yield linked
            return
        else:
            places = self._reader.pointing_at(path.removeprefix(TYPES))
        for place in self._heaviest(place for place in places if _is_set(place))[:_PLACES]:
            # A modifier of the object itself cannot lead to it, nor can its own pointers.
            if variable == "obj" and (place.owner == _OBJECT or self._is_on_object(place.owner)):
                continue
            if self._reader.descends(place.owner, f"{TYPES}NodeTree") and place.owner not in self._shown:
                continue
            ready = self._instances.of(place.owner)
            if ready is not None and variable != ready.expression:
                self._shown.add(place.owner)
                yield from ready.steps
                yield f"`{ready.expression}.{place.name} = {variable}`"
                return

    def object_of(self, cls: str) -> list[str]:
        """The steps that make an object of new object data; none for what is none."""
        creation = self._reader.creations([_OBJECT]).get(_OBJECT) if self._is_object_data(cls) else None
        if creation is None:
            return []
        kinds = (kind for kind in self._kinds_of_objects if self._reader.descends(cls, self.data_of(kind)))
        self._instances.add_object(next(kinds, ""))
        call = _NEW_NAME.sub(f'new("{cls.removeprefix(TYPES)}"', creation.call)
        return [f"`obj = {call}`; `bpy.context.collection.objects.link(obj)`"]

    def tree_of(self, node: str) -> list[str]:
        """The steps that make the tree that takes a node, where it is not there."""
        return [*self._tree(node)]

    def data_of(self, kind: str) -> str:
        """The class of the data of an object's type: Volume of ``VOLUME``; empty for a type without data."""
        return self._kinds_of_objects.get(kind, "")

    def _is_on_object(self, cls: str) -> bool:
        creation = self._reader.creations([cls]).get(cls)
        return creation is not None and creation.call.startswith("obj.")

    def _deforming(self, path: str) -> Iterator[str]:
        """The modifier of the data's name, by which its object changes another: an Armature modifier."""
        modifier = f"{path}Modifier"
        creation = self._reader.creations([modifier]).get(modifier)
        pointer = self._reader.entry(f"{modifier}.object")
        if creation and pointer and pointer.target == "Object":
            call = creation.call.replace("obj.", "other.", 1)
            yield f"on another object, that it changes: `modifier = {call}`, then `modifier.object = obj`"

    def _linked(self, path: str) -> str:
        """The call that links a data-block to where it counts: a collection to the scene's."""
        for entry in self._reader.by_name("link"):
            symbol = self._reader.symbol(entry.path) if entry.kind == "function" else None
            if symbol is None or path.removeprefix(TYPES) not in {
                p.type for p in symbol.parameters if p.required
            }:
                continue
            holders = (
                self._reader.entry(one)
                for one in self._reader.collections_of(entry.owner.removeprefix(TYPES))
            )
            for holder in holders:
                owner = self._reader.symbol(holder.owner) if holder else None
                if holder and owner and owner.reached and "[" not in owner.reached:
                    return f"`{owner.reached}.{holder.name}.link({self.variable_of(path)})`"
        return ""

    def _is_object_data(self, path: str) -> bool:
        data = set(self._kinds_of_objects.values())
        return any(entry.path in data for entry in self._reader.lineage(path))

    @cached_property
    def _kinds_of_objects(self) -> dict[str, str]:
        """An object's type → the class of its data."""
        types = self._reader.symbol(f"{TYPES}Object.type")
        classes = {key(name): path for path, name in self._reader.data_classes if path == f"{TYPES}{name}"}
        found: dict[str, str] = {}
        for item in types.enum_items if types else ():
            for name in (key(item.identifier), key(item.name)):
                if name in classes and self._is_animated(classes[name]):
                    found.setdefault(item.identifier, classes[name])
        return found

    def _is_animated(self, path: str) -> bool:
        """Whether things of a class have animation data, as all data of objects has; a text has none."""
        return self._reader.entry(f"{path}.animation_data") is not None

    def _named_pointers(self) -> list[SymbolEntry]:
        """Properties called as the topic is: ``Scene.camera``."""
        entries = [entry for name in self._stems() for entry in self._reader.by_name(name)]
        return [entry for entry in entries if entry.kind == "property" and entry.type == "pointer"]

    def _stems(self) -> list[str]:
        """The topic's keys, in the singular too."""
        names = (name for each in sorted(self._names.keys) for name in (each, each.removesuffix("s")))
        return [name for name in dict.fromkeys(names) if len(name) > 3]

    # What is set

    def _set(self, path: str) -> Iterator[str]:
        """A thing's own settings and functions, then the settings that it points to, and those below, where they belong
        to the topic or are its cache.
        """
        variable = self.variable_of(path)
        symbol = self._reader.symbol(path)
        if self._creations[path].call.startswith("bpy.ops.") and symbol is not None and symbol.reached:
            variable = symbol.reached
            if _OTHERS_ELEMENT.search(variable):
                return
        if own := self._settings(path):
            yield f"set on `{variable}`: {own}"
        members = self._reader.members(path).values()
        held = [entry for entry in members if entry.type == "collection" and self._weight(entry) >= 1]
        if held:
            items = (self._held(entry, variable) for entry in self._heaviest(held)[:_FUNCTIONS])
            yield f"in `{variable}`: " + ", ".join(items)
        yield from self._parts(path, variable)
        functions = [entry for entry in members if entry.kind == "function" and self._weight(entry) >= 1]
        if functions:
            calls = (f"`{variable}.{_call_of(entry)}`" for entry in self._heaviest(functions)[:_FUNCTIONS])
            yield "call " + ", ".join(calls)
        waiting, left = [(path, variable)], _HOLDERS
        while waiting and left:
            path, above = waiting.pop(0)
            for entry in self._heaviest(self._reader.members(path).values()):
                target = f"{TYPES}{entry.target}"
                # What is a thing's own cannot be replaced; another data-block can.
                is_own = not _is_set(entry) or self._reader.descends(target, f"{TYPES}ID")
                if entry.type != "pointer" or not is_own or not self._belongs(target):
                    continue
                pointer = self._reader.symbol(entry.path)
                if pointer is None or stays_empty(pointer):
                    continue
                self._shown.add(target)
                waiting.append((target, f"{above}.{entry.name}"))
                if left and (settings := self._settings(target)):
                    left -= 1
                    yield from self._filled(pointer, above)
                    yield f"set on `{above}.{entry.name}` (`{entry.target}`): {settings}"

    def _held(self, entry: SymbolEntry, variable: str) -> str:
        """A collection of a thing, and the call that adds to it."""
        target = f"{TYPES}{entry.target}"
        made = self._reader.creations([target]).get(target)
        adds = made is not None and made.maker.rpartition(".")[0] == f"{TYPES}{entry.collection}"
        call = made.call.partition(f".{entry.name}.")[2] if made and adds else ""
        by = f", by `{variable}.{entry.name}.{call}`" if call else ""
        return f"`.{entry.name}` (`{entry.target}`{by})"

    def _filled(self, pointer: Symbol, above: str) -> Iterator[str]:
        """What fills a pointer of ``above`` that is None on new things."""
        calls = self._instances.filled(pointer, above)
        # One value of a setting makes one thing, another value the next, in place of the first.
        choices = {call.partition(" = ")[0] for call in calls if " = " in call}
        elsewhere = "on another object: " if choices & self._chosen else ""
        self._chosen |= choices
        if calls:
            yield elsewhere + filling(calls, f"{above}.{pointer.name}")

    def _parts(self, path: str, variable: str) -> Iterator[str]:
        """Calls that make parts of a thing through what it points to: ``tree.interface.new_socket(…)``."""
        for cls in self._reader.lineage(path):
            for entry in self._reader.members(cls.path).values():
                target = f"{TYPES}{entry.target}"
                if entry.type == "pointer" and not _is_set(entry) and target not in self._names.classes:
                    for function in self._heaviest(self._reader.members(target).values())[:2]:
                        if function.kind == "function" and function.name.startswith("new"):
                            choices = self._choices(function, path)
                            yield f"`{variable}.{entry.name}.{_call_of(function)}`{choices}"

    def _choices(self, function: SymbolEntry, cls: str) -> str:
        """The values of a function's arguments that are a choice, of those that an instance of the class takes."""
        symbol, made = self._reader.symbol(function.path), self._reader.entry(cls)
        label = made.label.lower() if made else ""
        told: list[str] = []
        for parameter in symbol.parameters if symbol else ():
            taken = [item.identifier for item in parameter.enum_items if _is_taken(item.where, label)]
            if len(taken) > 1:
                values = "|".join(map(repr, taken[:_VALUES])) + ("|…" if len(taken) > _VALUES else "")
                told.append(f"`{parameter.name}={values}`")
        return f" ({', '.join(told)})" if told else ""

    def _belongs(self, path: str) -> bool:
        return path not in self._shown and (path in self._names.classes or path == _CACHE)

    def _settings(self, path: str) -> str:
        entries = [
            entry
            for entry in self._reader.members(path).values()
            if entry.kind == "property"
            and entry.type not in {"pointer", "collection"}
            and entry.name not in _PLAIN
            and _is_set(entry)
        ]
        return ", ".join(_short(entry) for entry in self._heaviest(entries)[:_SETTINGS])

    # What is there without being made

    def _there(self) -> Iterator[str]:
        """The topic's settings that are reached without being made: ``RenderSettings``."""
        left = 2
        for path in self._classes:
            if path in self._shown or path in self._creations or not self._counts(path) or not left:
                continue
            symbol = self._reader.symbol(path)
            reached = symbol.reached if symbol else ""
            # An element of a collection is there only if somebody has made it.
            if not reached or "[" in reached or any(part in reached for part in _INTERFACE):
                continue
            if symbol and (settings := self._settings(path)):
                left -= 1
                self._shown.add(path)
                ready = self._instances.reach(held(reached))
                if ready is None:
                    step = f"`{reached}` (`{path.removeprefix(TYPES)}`): {settings}"
                    self._waiting.append(f"set, once it is not None, on {step}")
                    continue
                yield from ready.steps
                yield f"set on `{reached}` (`{path.removeprefix(TYPES)}`): {settings}"

    def _functions(self) -> Iterator[str]:
        """Functions that every thing has and that are called as the topic is: ``keyframe_insert``."""
        paths = [path for name in self._stems() for path in self._reader.functions_named(name)]
        entries = (self._reader.entry(path) for path in paths if path.startswith(f"{STRUCT}."))
        for entry in self._heaviest(entry for entry in entries if entry)[:_FUNCTIONS]:
            yield f"`obj.{_call_of(entry)}` — {entry.line.partition(' — ')[2]}"

    # What runs it

    def _run(self) -> Iterator[str]:
        weights = self._reader.weights(list(self._names.operators))
        operators = [
            path
            for path in self._names.operators
            if not _has(path, (*_MAKES, *_REMOVES))
            and weights.get(path, 0) >= (1 if path.split(".")[2] in self._names.keys else _USED_ELSEWHERE)
        ]
        if _CACHE in self._shown:
            operators = [*self._bakes(), *operators]
        yield from map(self._operator, operators[:_RUNS])

    def _operator(self, path: str) -> str:
        """An operator's call with its first arguments, and what it does."""
        symbol = self._reader.symbol(path)
        given = [p for p in symbol.parameters if p.default is not None] if symbol else []
        arguments = [f"{p.name}={literal(p.default)}" for p in given[:_ARGUMENTS]]
        left = len(symbol.parameters) - len(arguments) if symbol else 0
        entry = self._reader.entry(path)
        said = entry.line.partition(" — ")[2] if entry else ""
        more = f" and {left} more" if left else ""
        asked = "; ".join(_asked(symbol, self._reader)) if symbol else ""
        return (
            f"`{path}({', '.join(arguments)})`{more}"
            + (f" — {said}" if said else "")
            + (f" ({asked})" if asked else "")
        )

    def _bakes(self) -> Iterator[str]:
        """The heaviest operator of the page that explains the cache."""
        for target in self._reader.manual_links(_CACHE):
            paths = self._reader.symbols_of_page(target.partition("#")[0])
            entries = (self._reader.entry(path) for path in paths if not _has(path, (*_MAKES, *_REMOVES)))
            operators = [entry for entry in entries if entry and entry.kind == "operator"]
            yield from (entry.path for entry in self._heaviest(operators)[:1])

    # Order

    def _heaviest(self, entries: Iterable[SymbolEntry]) -> list[SymbolEntry]:
        """Entries by weight; those of equal weight keep their order."""
        found = list(entries)
        weights: Mapping[str, float] = self._reader.weights([entry.path for entry in found])
        return sorted(found, key=lambda entry: -weights.get(entry.path, 0.0))

    def _weight(self, entry: SymbolEntry) -> float:
        return self._reader.weights([entry.path]).get(entry.path, 0.0)


def _asked(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """What must be before an operator runs, and does what is wanted."""
    if needs := operator_needs(symbol):
        yield f"takes {needs}"
    elif not refused_nothing(symbol):
        yield "not seen to run without a window"
    yield from panel_lines(symbol, reader)


def _is_taken(where: str, label: str) -> bool:
    """Whether an item is taken by a new thing of this label."""
    kind, _, labels = where.partition(" by ")
    if not labels or labels.endswith("…"):
        return True
    return (label in labels.split(", ")) == (kind == "only")


def _is_set(entry: SymbolEntry) -> bool:
    return "read-only" not in entry.line.partition(" — ")[0]


def _has(path: str, verbs: Sequence[str]) -> bool:
    return not set(path.rpartition(".")[2].split("_")).isdisjoint(verbs)


def _short(entry: SymbolEntry) -> str:
    """A property with its default and its first values, without its type: ``quality` = 5``."""
    name, _, rest = entry.line.partition(" — ")[0].partition(" ")
    rest = rest.removeprefix(entry.type).strip()
    return f"{name} {rest.partition('] ')[2] if rest.startswith('[') else rest}".strip()


def _call_of(entry: SymbolEntry) -> str:
    """A call as it can be written: without ``self``, and without the marks of how arguments are given."""
    call = entry.line.partition("`")[2].partition("`")[0]
    return call.replace("(self, ", "(").replace("*, ", "").replace(", /", "")
