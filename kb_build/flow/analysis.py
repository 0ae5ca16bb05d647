"""Reads a script as text and tells what its expressions are: nothing is imported or run."""

from __future__ import annotations

import ast
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.core import StepsExhausted
from kb_build.flow.statements import Statements

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.flow.api import Api
    from kb_build.flow.types import Resolution, Type

MOST_CHARACTERS = 2_000_000
MOST_STEPS = 4_000_000  # expressions that are read, some more than once
_STEPS_PER_CHARACTER = 4
_ROUNDS = 3


@dataclass(frozen=True, slots=True)
class Analysis:
    """What a script is. ``tree`` is None, and ``error`` says why, when it cannot be read.

    ``types`` has every expression that was reached, ``resolutions`` every part that stands for something of the
    API. ``complete`` is False where the script was too large to be read to its end. ``own_operators`` are the
    operators that the script defines (paths below bpy.ops, their modules too), ``registered`` the properties that it
    gives to classes of the API: (class, name).
    """

    tree: ast.Module | None
    types: Mapping[ast.expr, Type]
    resolutions: Mapping[ast.AST, Resolution]
    error: SyntaxError | None = None
    complete: bool = True
    own_operators: frozenset[str] = frozenset()
    registered: frozenset[tuple[str, str]] = frozenset()


class Analyzer(Statements):
    """One analysis of one script."""

    def read(self, tree: ast.Module) -> bool:
        """Reads the module, then every function with what it is known to receive; whether all could be read."""
        self.loops = []
        try:
            self._guarded_read(tree)
            for _ in range(_ROUNDS):
                if not self._read_functions():
                    break
        except StepsExhausted:
            return False
        return True

    def _guarded_read(self, tree: ast.Module) -> None:
        for statement in tree.body:
            depth = self.depth
            try:
                if not self.read_body([statement]):
                    break
            except RecursionError:
                self.depth, self.scope, self.function = depth, self.module, None

    def _read_functions(self) -> bool:
        """Reads the functions that were not read yet, or that know more now; whether there were any."""
        found = False
        # Those that the API calls pass on what they get: they come first.
        pending = sorted(range(len(self.functions)), key=lambda number: self.functions[number].cls is None)
        for number in pending:
            function = self.functions[number]
            if function.runs >= _ROUNDS or (not function.stale and function.seen == self.stamp(function)):
                continue
            found = True
            depth = self.depth
            try:
                self.run(number)
            except RecursionError:
                self.depth, self.scope, self.function = depth, self.module, None
        return found or any(function.stale for function in self.functions)


def analyse(code: str, api: Api, version: tuple[int, ...] = ()) -> Analysis:
    """Reads a script. ``version`` is the Blender that it is read for: branches for others are left out.

    Bad input of every kind ends in an Analysis that says so, in bounded time.
    """
    if len(code) > MOST_CHARACTERS:
        return _failed(
            f"the script is too large ({len(code):,} characters; up to {MOST_CHARACTERS:,} are read)"
        )
    code = code.removeprefix("\ufeff")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(code)
    except SyntaxError as error:
        return Analysis(None, {}, {}, error)
    except (ValueError, RecursionError, MemoryError) as error:
        return _failed(f"the script cannot be parsed: {error or type(error).__name__}")
    steps = min(MOST_STEPS, 20_000 + _STEPS_PER_CHARACTER * len(code))
    analyzer = Analyzer(api, version, steps)
    complete = analyzer.read(tree)
    return Analysis(
        tree,
        analyzer.types,
        analyzer.resolutions,
        complete=complete,
        own_operators=frozenset(analyzer.own_operators),
        registered=frozenset(analyzer.registered),
    )


def _failed(reason: str) -> Analysis:
    return Analysis(None, {}, {}, SyntaxError(reason))
