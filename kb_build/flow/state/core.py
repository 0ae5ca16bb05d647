"""What every part of the analysis shares: the script's definitions, the place that is being read, and the results."""

from __future__ import annotations

import ast
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.state.definitions import ClassDefinition, FunctionDefinition
from kb_build.flow.state.doubts import NO_DOUBTS, Doubts
from kb_build.flow.state.place import Place
from kb_build.flow.state.source_files import SourceFile
from kb_build.flow.values.type_parts import HOLDING, given_away
from kb_build.flow.values.types import (
    UNKNOWN,
    Builtin,
    ClassObject,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Mapping,
    Module,
    Resolution,
    Sequence,
    Tuple,
    Type,
    join,
    literal_text,
    members,
    union,
)

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Iterator
    from collections.abc import Sequence as Rows

    from kb_build.flow.blender.api import Api
    from kb_build.flow.state.scopes import State
    from kb_build.flow.values.types import Given, ResolutionKind

DEEPEST_RUN = 60  # a function that is called further inside is read later
DEEPEST = 160  # expressions and calls within each other
# What is noted of an attribute that nothing had at first, and that was read again when something had given it.
_TOLD_LATER = Builtin("told later")
_MOST_BASES = 40
_IN_ONE_STEP = 64  # names that are gone through in about the time in which an expression is read
Reader = FunctionDefinition | SourceFile
EVERY_ERROR = "BaseException"
ANY = "*"  # any class, any name: what a script computes


class StepsExhausted(Exception):  # noqa: N818 - reads as the state it names
    """The script is larger than what the analysis may spend on it."""


class Core:
    """One analysis. The parts are mixed into one class (analysis.Analyzer), since types flow between all of them."""

    def __init__(self, api: Api, version: tuple[int, ...], files: Rows[SourceFile]) -> None:
        self.api = api
        self.version = version
        self.sources = files
        self.files = {file.name: file for file in reversed(files)}
        self.folders = {
            ".".join(parts[:length])
            for name in self.files
            for parts in [name.split(".")]
            for length in range(1, len(parts))
        }
        self.here = Place.module(files[0])
        for file in files:
            # Blender's console, and what runs code for others, bring it: their scripts do not import it.
            file.module.bind("bpy", Module("bpy"))
        self.functions: list[FunctionDefinition] = []
        self.classes: list[ClassDefinition] = []
        self.derived: dict[int, list[int]] = {}
        self.numbers: dict[ast.AST, int] = {}
        self.own_operators: set[str] = set()
        self.own_types: dict[str, Type] = {}
        self.registered: dict[tuple[str, str], Type] = {}
        self.rounds = False  # all modules were read, their functions are
        self.settled = False  # and no function will be read again for all its calls
        self.charged, self.steps_left = files[0], files[0].steps_left
        self._bases: dict[int, tuple[tuple[str, ...], bool]] = {}
        self._denials: list[tuple[dict[ast.AST, Resolution], ast.AST, Reader]] = []

    # What the analysis may spend.

    def spend(self, things: int) -> None:
        """Takes the time to go once through so many names, chains or doubts off what may be spent."""
        self.steps_left -= things // _IN_ONE_STEP
        if self.steps_left < 0:
            raise StepsExhausted

    @contextmanager
    def charged_to(self, file: SourceFile) -> Generator[None]:
        """Takes what is read off what may be spent on a file, whoever calls for it; one that takes too long is left."""
        outer, left, is_tried = self.charged, self.steps_left, self.here.tries
        if not is_tried:
            outer.steps_left = left
        self.charged, self.steps_left = file, file.steps_left
        try:
            yield
        except StepsExhausted:
            file.complete = False
        finally:
            file.steps_left = self.steps_left
            self.charged, self.steps_left = outer, left if is_tried else outer.steps_left

    def copied(self, state: State) -> State:
        """The same state, to be changed on its own; this pays for joining it with others too."""
        things, doubted = len(state.names), state.doubted
        if state.chains or doubted is not NO_DOUBTS:
            things += len(state.chains) + len(doubted.members) + len(doubted.chains)
        if things >= _IN_ONE_STEP:
            self.spend(things)
        return state.copy()

    def bind(self, name: str, kind: Type) -> None:
        """Binds a name here; the chains that begin with it are sought for."""
        if self.here.scope.state.chains:
            self.spend(len(self.here.scope.state.chains))
        self.here.scope.bind(name, kind)

    def doubt_here(self, doubts: Doubts) -> None:
        """Adds to what is doubted from here on."""
        state = self.here.scope.state
        if state.doubted is not NO_DOUBTS:
            self.spend(len(state.doubted.members) + len(state.doubted.chains))
        state.doubted |= doubts

    # What the parts give each other.

    def evaluate(self, node: ast.expr) -> Type:
        """The type of an expression; what it resolves to is recorded on the way."""
        raise NotImplementedError

    def call(self, callee: Type, node: ast.Call) -> Type:
        """What a call returns."""
        raise NotImplementedError

    def read_body(self, body: Rows[ast.stmt]) -> bool:
        """Reads statements one after the other; whether what follows them can be reached."""
        raise NotImplementedError

    def run(self, number: int) -> None:
        """Reads a function of the script with what it is known to receive."""
        raise NotImplementedError

    def result_of_call(self, number: int, given: dict[str, Type], node: ast.Call) -> Type:
        """What a function of the script returns to a call that passes this; it was read for all calls before."""
        raise NotImplementedError

    def returns_still(self, number: int, received: Given, kind: Type | None) -> bool:
        """Whether a function of the script is still known to return something to a call that passes this."""
        raise NotImplementedError

    def read_file(self, file: SourceFile) -> None:
        """Reads a file's module, unless that was begun before."""
        raise NotImplementedError

    @contextmanager
    def at(self, place: Place) -> Generator[None]:
        """Reads at another place, and comes back; also where the time or Python's stack is spent there."""
        outer, self.here = self.here, place
        try:
            yield
        finally:
            self.here = outer

    @contextmanager
    def ready_for(self, errors: Iterable[str] = (EVERY_ERROR,)) -> Generator[None]:
        """Reads here what may raise some errors, by the names of their classes, with no harm."""
        here, outer = self.here, self.here.caught
        here.caught = outer.union(errors)
        try:
            yield
        finally:
            here.caught = outer

    def bind_target(self, target: ast.expr, kind: Type, value: ast.expr | None = None) -> None:
        """Assigns to a name, an attribute, an item, or several of them."""
        raise NotImplementedError

    def narrow(self, test: ast.expr, *, holds: bool, asked: Doubts | None = None) -> None:
        """Applies what is known once a condition holds or does not; ``asked``: see :meth:`guards.Guards.doubt`."""
        raise NotImplementedError

    # Results.

    def resolve(  # noqa: PLR0913, PLR0917 - the fields of a resolution
        self,
        node: ast.AST,
        kind: ResolutionKind,
        value: str,
        symbols: Rows[str] = (),
        missing: Rows[str] = (),
        possible: Rows[str] = (),
        *,
        sure: bool = True,
        guarded: bool = False,
    ) -> None:
        """Records what a part of the script stands for; a later reading of the same part replaces it."""
        here, doubts = self.here, self.here.scope.state.doubted
        doubted = guarded or doubts.has_member(value) or (here.tries and doubts.chosen)
        here.resolutions[node] = Resolution(
            node, kind, value, _once(symbols), _once(missing), _once(possible), sure and not here.guessing,
            doubted or bool(here.caught), here.statement, frozenset() if doubted else here.caught,
        )  # fmt: skip
        if missing and not here.tries:
            self._denials.append((here.resolutions, node, self.reader))

    def is_current(self, reader: Reader) -> bool:
        """Whether what a function or a module took from other definitions is still all that is known of them."""
        return all(
            self._known(number, name) == kind
            if isinstance(name, str)
            else self.returns_still(number, name, kind)
            for (number, name), kind in reader.readings.items()
        )

    def doubt_denials(self) -> None:
        """Marks as unsure what was found missing in what turned out to be more, and was not read again."""
        told_more: dict[int, frozenset[str] | None] = {}
        for resolutions, node, reader in self._denials:
            row = resolutions.get(node)
            if row is None or not row.missing or not row.sure:
                continue
            if id(reader) not in told_more:
                told_more[id(reader)] = self._given_later(reader)
            later = told_more[id(reader)]
            if later is None or row.value in later:
                resolutions[node] = replace(row, sure=False)

    def _given_later(self, reader: Reader) -> frozenset[str] | None:
        """The names that classes had not when a function or a module asked, and were given: of what follows from them
        nothing was known. None where it took what turned out to be something else.
        """
        names: set[str] = set()
        for (number, name), kind in reader.readings.items():
            if not isinstance(name, str):
                if not self.returns_still(number, name, kind):
                    return None
            elif self._known(number, name) != kind:
                if not name or kind is not None or self.has_by_api(number, name):
                    return None
                names.add(name)
        return frozenset(names)

    def has_by_api(self, number: int, name: str) -> bool:
        """Whether a class has a name by those of the API that it derives from."""
        return any(self.api.member(base, name) for base in self.api_bases(number)[0])

    @property
    def reader(self) -> Reader:
        """What is being read: a function, or a file's module."""
        return self.here.function or self.here.file

    def comes_surely(self, text: str) -> bool:
        """Whether a text that a name holds surely is what is used here: nothing asks for it, or chooses by it."""
        doubted = self.here.scope.state.doubted
        return not (self.here.caught or self.here.guessing or doubted.chosen or doubted.has_member(text))

    def _known(self, number: int, name: str) -> Type | None:
        if not name:
            return self.functions[number].returned
        found = self._find_attribute(number, name)
        return found[0] if found else None

    # What a script adds to the API.

    def register(self, owners: Type, name: str, kind: Type, *, declared: bool) -> None:
        """Remembers what is given to classes; ``declared`` where it is one of bpy.props, whatever they are."""
        for owner in members(owners):
            if isinstance(owner, ClassObject):
                member = self.api.member(owner.cls, name)
                if member is None or (declared and member.symbol.owner != owner.cls):
                    self.registered[owner.cls, name] = kind
            elif declared and not isinstance(owner, (LocalClass, LocalInstance)):
                self.registered[ANY, name] = kind

    def is_declared(self, node: ast.expr | None) -> bool:
        """Whether an expression, which was read, calls one of bpy.props."""
        found = self.here.resolutions.get(node) if node is not None else None
        return found is not None and any(path.startswith("bpy.props.") for path in found.symbols)

    def is_declared_in(self, number: int, name: str) -> bool:
        """Whether a class, or one that it derives from, declares a property by bpy.props."""
        return any(
            isinstance(kind, LocalClass) and name in self.classes[kind.number].declared
            for kind in self.ancestors(number)
        )

    # Definitions.

    def define_function(
        self, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda, cls: int | None = None
    ) -> int:
        """The number of a function's definition; the same one when it is read again."""
        number = self.numbers.get(node)
        if number is None:
            number = self.numbers[node] = len(self.functions)
            doubted = self.here.scope.state.doubted
            self.spend(len(doubted.members))
            self.functions.append(
                FunctionDefinition(node, self.here.scope, cls, file=self.here.file, doubted=doubted.anywhere)
            )
        elif not self.here.tries:
            self.functions[number].scope = self.here.scope  # what is around it may know more by now
        return number

    def ancestors(self, number: int) -> Iterator[Type]:
        """A class of the script and what it derives from, as LocalClass, ClassObject or UNKNOWN; nearest first."""
        queue: list[Type] = [LocalClass(number)]
        for _ in range(_MOST_BASES):
            if not queue:
                return
            kind = queue.pop(0)
            yield kind
            if isinstance(kind, LocalClass):
                queue.extend(self.classes[kind.number].bases)

    def class_attribute(self, number: int, name: str) -> tuple[Type, int] | None:
        """An attribute that the script gives to a class or to one of its bases: (type, class)."""
        found = self._find_attribute(number, name)
        if found is None or not isinstance(found[0], LocalFunction):
            self.note(number, name, found[0] if found else None)
        return found

    def fill(self, target: ast.expr, filled: Type) -> None:
        """What a list or a dictionary is from here on that a name holds, an attribute of the script's own things, or
        another list or dictionary.
        """
        match target:
            case ast.Name(id=name) if name in self.here.scope.state.names:
                self.bind(name, filled)
            case ast.Name(id=name):
                self.here.scope.fill_outside(name, filled)
            case ast.Attribute(value=value, attr=name):
                of = self.here.types.get(value, UNKNOWN)
                if isinstance(of, (LocalInstance, LocalClass)):
                    found = self._find_attribute(of.number, name)
                    self.classes[found[1] if found else of.number].bind(name, filled)
            case (
                ast.Subscript(value=holder, slice=key)
                | ast.Call(func=ast.Attribute(value=holder, attr="setdefault"), args=[key, _])
            ):
                if (outer := self._holding(holder, key, filled)) is not None:
                    self.fill(holder, outer)
            case _:
                pass

    def give_away(self, node: ast.expr, kind: Type) -> Type:
        """What is held in a second place, too: what is empty may be filled there."""
        if not isinstance(kind, HOLDING) or (given := given_away(kind)) == kind:
            return kind
        self.fill(node, given)
        return given

    def _holding(self, holder: ast.expr, key: ast.expr, filled: Type) -> Type | None:
        """What holds a list or a dictionary, once that is ``filled``; None for what is neither."""
        match self.here.types.get(holder, UNKNOWN):
            case Mapping() as outer:
                text = literal_text(self.here.types.get(key, UNKNOWN))
                if any(name == text for name, _ in outer.items):
                    items = tuple((name, filled if name == text else kind) for name, kind in outer.items)
                    return replace(outer, value=union(kind for _, kind in items), items=items)
                return Mapping(outer.key, join(outer.value, filled))
            case Sequence() as outer:
                return replace(outer, element=join(outer.element, filled))
            case Tuple(items=items):
                return Sequence("list", union((*items, filled)))
            case _:
                return None

    def returned(self, number: int) -> Type | None:
        """What a function is known to return so far; None where nothing is known."""
        kind = self.functions[number].returned
        self.note(number, "", kind)
        return kind

    def note(self, number: int, name: str | Given, kind: Type | None) -> None:
        """Remembers what was taken from another definition (see :data:`types.Readings`)."""
        first = self.reader.readings.setdefault((number, name), kind)
        if first is None and kind is not None:
            self.reader.readings[number, name] = _TOLD_LATER

    def _find_attribute(self, number: int, name: str) -> tuple[Type, int] | None:
        for kind in self.ancestors(number):
            if isinstance(kind, LocalClass):
                found = self.classes[kind.number].attributes.get(name)
                if found is not None:
                    return found, kind.number
        return None

    def api_bases(self, number: int) -> tuple[tuple[str, ...], bool]:
        """The classes of the API that a class of the script derives from, and whether all its bases are known.

        A class without any that others of the script derive from has those of the others: it is mixed into them.
        """
        bases, known = self.direct_bases(number)
        if bases or not known:
            return bases, known
        mixed = dict.fromkeys(
            base for other in self.derived.get(number, ()) for base in self.direct_bases(other)[0]
        )
        return tuple(mixed), not mixed

    def direct_bases(self, number: int) -> tuple[tuple[str, ...], bool]:
        """The same without what others are mixed into: what the class itself derives from."""
        found = self._bases.get(number)
        if found is None:
            bases: list[str] = []
            known = True
            for kind in self.ancestors(number):
                if isinstance(kind, ClassObject):
                    bases.append(kind.cls)
                elif not isinstance(kind, LocalClass):
                    known = False
            found = self._bases[number] = tuple(bases), known
        return found

    def bound(self, kind: Type, receiver: Type) -> Type:
        """A class attribute as it is read from an instance or a class: methods are bound."""
        if not isinstance(kind, LocalFunction):
            return kind
        function = self.functions[kind.number]
        if function.is_static:
            return kind
        if function.is_property:
            is_open = function.returned is None and not function.running and not self.here.tries
            if is_open and self.here.depth < DEEPEST_RUN:
                self.run(kind.number)
            return self.returned(kind.number) or UNKNOWN
        return LocalFunction(kind.number, receiver)


def _once(paths: Rows[str]) -> tuple[str, ...]:
    """The same paths, each once."""
    return tuple(paths) if len(paths) < 2 else tuple(dict.fromkeys(paths))
