"""Reads a script as text and tells what its expressions are: nothing is imported or run."""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.flow.calls.dispatch import Calls
from kb_build.flow.execution.functions import Functions
from kb_build.flow.execution.statements import Statements
from kb_build.flow.state.other_versions import doubt_what_others_use
from kb_build.flow.state.source_files import SourceFile, keeps_annotations, module_name
from kb_build.flow.syntax.parse import parsed, too_long
from kb_build.flow.syntax.trees import nodes_in

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from kb_build.flow.blender.api import Api
    from kb_build.flow.state.core import Reader
    from kb_build.flow.values.types import Given, Resolution, Type

MOST_STEPS = 4_000_000  # expressions that are read, some more than once
_STEPS_PER_CHARACTER = 4
_ROUNDS = 3  # in which a function is read for what its module and its class bind
_MOST_FOLLOWED = 4  # times
_MOST_ROUNDS = 6  # in which it is read for what calls pass
_DEEPEST_IMPORT = 20  # files that import each other are read within each other


@dataclass(frozen=True, slots=True)
class Analysis:
    """What a script is. ``tree`` is None, and ``error`` says why, when it cannot be read.

    ``types`` has every expression that was reached, ``resolutions`` every part that stands for something of the
    API. ``complete`` is False where the script was too large, or too deep, to be read to its end. ``doubted`` are the
    statements, and parts of them, that stand behind a condition on Blender's version which is not decided.
    ``functions`` and ``classes`` are the definitions by the numbers that LocalFunction and LocalClass have.

    ``carried`` is what more is missing where texts are used that come from elsewhere: by calls, by a loop's turns.

    What the script, or one that is analysed with it, adds to the API: ``own_operators`` are operators (paths below
    bpy.ops, their modules too), ``registered`` the properties of classes (class, name), ``own_types`` the names of
    classes below bpy.types. A ``*`` stands for any class or name, where the script computes it.
    """

    tree: ast.Module | None
    types: Mapping[ast.expr, Type]
    resolutions: Mapping[ast.AST, Resolution]
    error: SyntaxError | None = None
    complete: bool = True
    own_operators: frozenset[str] = frozenset()
    registered: frozenset[tuple[str, str]] = frozenset()
    own_types: frozenset[str] = frozenset()
    doubted: Collection[ast.stmt | ast.expr] = ()
    functions: Sequence[ast.AST] = ()
    classes: Sequence[ast.ClassDef] = ()
    carried: Sequence[Resolution] = ()


class Analyzer(Statements, Functions, Calls):
    """One analysis of the files that are read together."""

    importing = 0

    def read(self) -> None:
        """Reads every module, then every function with what it is known to receive."""
        for file in self.sources:
            self.read_file(file)
        self.rounds = True
        for _ in range(_MOST_ROUNDS):
            if not self._read_functions():
                break
        self.settled = True
        self.doubt_denials()
        doubt_what_others_use(self.sources, self.numbers, self._is_called_by_blender)
        self._follow_calls()

    def _follow_calls(self) -> None:
        """Adds to what is found in files what the texts come to that calls pass, or that a loop goes through."""
        hidden = {id(file): nodes_in(file.doubted) for file in self.sources}
        waiting = [
            (file, reader)
            for file, reader in self._readers()
            if (reader.carried or reader.uses) and self.is_current(reader)
        ]
        followed: set[tuple[int, Given]] = set()
        found: set[tuple[ast.AST, str]] = set()
        # What a call leaves in a thing of the script changes what others found there: then they are read again.
        for _ in range(_MOST_FOLLOWED):
            late: list[tuple[SourceFile, Reader]] = []
            for file, reader in waiting:  # it grows
                _add_carried(file, reader, found)
                is_late = False
                for number, received, call in reader.uses:
                    if (number, received) in followed or call in hidden[id(file)]:
                        continue
                    reading = self.reading_for(number, received)
                    if reading is not None and not self.is_current(reading):
                        is_late = True
                        continue
                    followed.add((number, received))
                    if reading is not None:
                        waiting.append((reading.file or file, reading))
                if is_late:
                    late.append((file, reader))
            waiting = late

    def _readers(self) -> Iterator[tuple[SourceFile, Reader]]:
        yield from ((file, file) for file in self.sources)
        yield from ((function.file, function) for function in self.functions if function.file)

    def _is_called_by_blender(self, node: ast.AST) -> bool:
        """Whether it is a method that Blender calls, or may: its class's, or one that classes derived from it have."""
        number = self.numbers.get(node)
        cls = (
            self.functions[number].cls if number is not None and not isinstance(node, ast.ClassDef) else None
        )
        name = getattr(node, "name", "")
        return cls is not None and self.has_by_api(cls, name)

    def read_file(self, file: SourceFile) -> None:
        """See :class:`core.Core`."""
        if file.started or file.tree is None or self.importing > _DEEPEST_IMPORT:
            return
        file.started = True
        file.module.shared = file.shared_names[file.tree]
        self.importing += 1
        try:
            with (
                self.charged_to(file),
                self.at(replace(self.here.further(file, file.module, None), tries=False)),
            ):
                self._guarded_read(file)
        finally:
            self.importing -= 1

    def _guarded_read(self, file: SourceFile) -> None:
        assert file.tree is not None
        for statement in file.tree.body:
            doubted = file.module.state.doubted
            try:
                with self.at(self.here.further(file, file.module, None)):
                    if not self.read_body([statement]):
                        break
            except RecursionError:
                file.module.state.doubted = doubted
                file.unread.add(statement)

    def _read_functions(self) -> bool:
        """Reads the functions that were not read yet, or that know more now; whether there were any."""
        found = False
        for number in sorted(range(len(self.functions)), key=self._turn):
            function = self.functions[number]
            file = function.file
            if file is None or not file.complete or function.runs >= _MOST_ROUNDS:
                continue
            settled = function.runs >= _ROUNDS or function.seen == self.stamp(function)
            if settled and not function.stale and self.is_current(function):
                continue
            found = True
            try:
                self.run(number)
            except RecursionError:
                file.unread.add(self.functions[number].node.args)
        return found or any(function.stale for function in self.functions)

    def _turn(self, number: int) -> int:
        """Functions that register come first, then those that the API calls: they pass on what they get."""
        function = self.functions[number]
        if getattr(function.node, "name", "").startswith("register"):
            return 0
        return 1 if function.cls is not None else 2


def _add_carried(file: SourceFile, reader: Reader, found: set[tuple[ast.AST, str]]) -> None:
    """Adds to a file what texts from elsewhere come to in what was read, each once; ``found`` are those that it has."""
    for place, row in reader.carried.items():
        known = file.resolutions.get(row.node)
        is_known = known is not None and known.missing and known.value == row.value and known.sure
        if not is_known and place not in found:
            found.add(place)
            file.carried_rows.append(row)


def analyse(code: str, api: Api, version: tuple[int, ...] = ()) -> Analysis:
    """Reads a script. ``version`` is the Blender that it is read for: branches for others are left out.

    Bad input of every kind ends in an Analysis that says so, in bounded time.
    """
    return analyse_files({"": code}, api, version)[""]


def analyse_files(files: Mapping[str, str], api: Api, version: tuple[int, ...] = ()) -> dict[str, Analysis]:
    """Reads files that belong together (path → text), as :func:`analyse` reads one; types flow between them.

    Paths use slashes and begin with the folder that is the package's name: ``addon/utils.py`` is found by
    ``from . import utils`` in ``addon/__init__.py``, and as ``addon.utils``.
    """
    sources = {path: _parsed(path, code) for path, code in files.items()}
    if not sources:
        return {}
    analyzer = Analyzer(api, version, list(sources.values()))
    analyzer.read()
    own = frozenset(analyzer.own_operators), frozenset(analyzer.registered), frozenset(analyzer.own_types)
    definitions = [one.node for one in analyzer.functions], [one.node for one in analyzer.classes]
    return {
        path: Analysis(
            source.tree,
            source.types,
            source.resolutions,
            source.error,
            source.is_read,
            *own,
            source.doubted,
            *definitions,
            source.carried_rows,
        )
        for path, source in sources.items()
    }


def _parsed(path: str, code: str) -> SourceFile:
    name, is_package = module_name(path)
    why_not = too_long(code)
    tree = SyntaxError(why_not) if why_not else parsed(code.removeprefix("\ufeff"))
    steps = min(MOST_STEPS, 20_000 + _STEPS_PER_CHARACTER * len(code))
    if isinstance(tree, SyntaxError):
        return SourceFile(name, is_package, None, steps, tree)
    return SourceFile(name, is_package, tree, steps, None, keeps_annotations=keeps_annotations(tree))
