"""What the beginning of an expression can stand for: a module, a class, or what a variable is called after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import words
from kb_build.symbols.api_names import ID, TYPES
from kb_build.symbols.python_values import is_new_list
from kb_serve.recognise.chains.chain_values import ChainValue
from kb_serve.recognise.chains.subscripts import INPUT_KEY, NODES_MODIFIER, PROPERTIES_OF_MODIFIER
from kb_serve.recognise.chains.variables import USUAL, Variables

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chain_values import ChainValues
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.chains.owners import Owners

ROOTS = {
    "C": "bpy.context",
    "D": "bpy.data",
    "context": "bpy.context",
    "ops": "bpy.ops",
    "types": "bpy.types",
}
PROPERTIES = "bpy.props."  # whose functions scripts import by name
# Whose classes and modules they do.
_IMPORTED = ("mathutils.", "bmesh.types.", "bpy_extras.")
_INSTANCE = "self"  # of a class of the script's own, whose attributes are like variables
_NAMED_LIKE_A_MODULE = 0.9  # fit of a class that a variable is named after, which is no module then
_MODULE_THAT_LACKS = 0.6  # … of a module that lacks what is read, by its last name
_OF_INPUTS = PROPERTIES_OF_MODIFIER.rpartition(".")[2]
_COLLECTION_FIT = 0.7  # of a variable with the name of a collection property that is used as one
_USUAL = 0.05
_LIGHTER = 0.0005  # for each that counts more
LEAST_OF_COLLECTION = _COLLECTION_FIT - _USUAL
_MOST_CALLED_SO = 60  # symbols of one name that are looked at
_MOST_NAMES = 8  # in the longest path


class ChainStarts:
    """Finds, in one base, what chains start from."""

    def __init__(self, reader: BaseReader, values: ChainValues, owners: Owners) -> None:
        self._reader = reader
        self._values = values
        self._owners = owners
        self._variables = Variables(reader)

    def of(self, chain: Chain) -> Iterator[tuple[ChainValue, int, float]]:
        """(value, steps used, fit) for everything that the chain's root can stand for."""
        if self._is_of_the_instance(chain):
            own = chain._replace(root=chain.steps[0].text, steps=chain.steps[1:])
            yield from ((value, 1, fit) for value, fit in self._of_variable(own, of_instance=True))
        elif (exact := self._rooted(chain)) and self._may_be_variable(chain, exact[0].symbol):
            named = self._named_like_a_module(chain.root, _first_name(chain))
            for rank, cls in enumerate(named):
                yield ChainValue(cls, cls), 0, _NAMED_LIKE_A_MODULE - 0.001 * rank
            if not named:
                yield from ((value, 0, fit) for value, fit in self._of_variable(chain))
            yield exact[0], exact[1], _MODULE_THAT_LACKS
        elif exact:
            yield exact
        else:
            yield from ((value, 0, fit) for value, fit in self._of_variable(chain))

    def _is_of_the_instance(self, chain: Chain) -> bool:
        """Whether a chain goes on from an attribute that only a script's own class can have: ``self.obj.location``."""
        if chain.root != _INSTANCE or not chain.steps[1:] or chain.steps[0].kind != "attr":
            return False
        return not any(entry.group == "ui" for entry in self._reader.names.by_name(_first_name(chain)))

    def _of_variable(self, chain: Chain, *, of_instance: bool = False) -> Iterator[tuple[ChainValue, float]]:
        """(value, fit) for everything that a variable, or an attribute of a script's own instance, can stand for: by
        its name, then by the member that it has.
        """
        seen: set[str] = set()
        by_key = [(NODES_MODIFIER, USUAL)] if _is_by_input(chain) else []
        for cls, fit in (*self._variables.classes(chain.root, of_instance=of_instance), *by_key):
            if cls not in seen:
                seen.add(cls)
                yield ChainValue(cls, cls), fit
        if not chain.steps:
            return
        named = self._owners.heaviest(self._reader.names.by_name(chain.root)[:_MOST_CALLED_SO])
        lists = [self._values.of(entry) for entry in named if is_new_list(entry.kind, entry.type)]
        yield from ((value, 1.0) for value in lists[:1])
        for rank, entry in enumerate(named):
            if (
                entry.kind == "property"
                and (value := self._values.of(entry)).many
                and self._is_used_as(value, chain)
            ):
                # An Object's modifiers are likelier than an FCurve's.
                is_usual = self._reader.descends(entry.owner, ID)
                yield value, _COLLECTION_FIT + (_USUAL if is_usual else 0.0) - _LIGHTER * rank
        for cls, fit in (*self._owners.with_socket(chain), *self._owners.of(chain)):
            if cls not in seen:
                seen.add(cls)
                yield ChainValue(cls, cls), fit

    def _may_be_variable(self, chain: Chain, module: str) -> bool:
        """Whether a root is called like a module that scripts import by its last name, and that lacks what is read."""
        entry = self._reader.entry(module)
        short = entry is not None and entry.kind == "module" and module != chain.root
        if not (chain.attributes and short and module.endswith(f".{chain.root}")) or module.startswith(
            "bpy."
        ):
            return False
        name = _first_name(chain)
        return bool(self._reader.names.by_name(name)) and self._reader.entry(f"{module}.{name}") is None

    def _named_like_a_module(self, variable: str, member: str) -> list[str]:
        """The classes that have a member and are called like a variable: ``noise.outputs`` is of a noise texture."""
        owners = {entry.owner for entry in self._reader.names.by_name(member)[:_MOST_CALLED_SO]}
        below = (cls.path for owner in owners for cls in self._reader.descendants(owner))
        named = {path for path in (*owners, *below) if variable in words(path.rpartition(".")[2])}
        weights = self._reader.usage.weights(named)
        return sorted(named, key=lambda path: (-weights.get(path, 0.0), len(path), path))

    def _is_used_as(self, value: ChainValue, chain: Chain) -> bool:
        """Whether a variable with a collection's name is used as one: indexed, or with a member of the collection."""
        step = chain.steps[0]
        return step.kind in {"key", "index"} or (
            step.kind == "attr" and self._reader.member_of(value.container, step.text) is not None
        )

    def _rooted(self, chain: Chain) -> tuple[ChainValue, int, float] | None:
        """The longest leading part that is a path itself: a module, a class, ``bpy.context``."""
        names = chain.dotted.split(".")
        names[:1] = ROOTS.get(names[0], names[0]).split(".")
        extra = len(names) - len(chain.dotted.split("."))
        paths = [".".join(names[:length]) for length in range(min(len(names), _MOST_NAMES), 0, -1)]
        packages = ("", PROPERTIES, TYPES, *_IMPORTED)
        self._reader.entry.load(package + path for path in paths for package in packages)
        for length, path in zip(range(len(paths), 0, -1), paths, strict=True):
            for package in packages:
                entry = self._reader.entry(package + path)
                is_imported = package or length > 1
                if entry and (is_imported or entry.kind in {"module", "class"}):
                    return self._values.of(entry), max(0, length - 1 - extra), 1.0
        return None


def _is_by_input(chain: Chain) -> bool:
    """Whether a variable is asked for what only inputs of a geometry-nodes modifier are called."""
    steps = chain.steps[1:] if _first_name(chain) == _OF_INPUTS else chain.steps
    return bool(steps) and steps[0].kind == "key" and INPUT_KEY.fullmatch(steps[0].text) is not None


def _first_name(chain: Chain) -> str:
    return next(iter(chain.attributes), "")
