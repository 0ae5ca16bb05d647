"""Recognises code: the symbols that its expressions resolve to, and those its bare names may mean."""

from __future__ import annotations

import builtins
import itertools
import json
import logging
import math
import os
import pathlib
import random
import re
import sys
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.paths import as_code, is_socket, plain_path
from kb_serve.recognise.by_words.said_otherwise import said_otherwise
from kb_serve.recognise.chains.animated_paths import path_given
from kb_serve.recognise.chains.chain_starts import LEAST_OF_COLLECTION
from kb_serve.recognise.chains.owners import TOLD_BY_MEMBER
from kb_serve.recognise.chains.subscripts import CustomProperties
from kb_serve.recognise.chains.variables import USUAL, usual_classes
from kb_serve.recognise.code.broken_expressions import (
    CLEAR,
    LEAST,
    LIKELY,
    BrokenExpressions,
    is_clear,
    likeliest_broken,
)
from kb_serve.recognise.code.loose_names import LooseNames
from kb_serve.recognise.code.names_beside import NamesBeside, said_in_words
from kb_serve.recognise.code.python_methods import note_on_method
from kb_serve.recognise.elsewhere.holders import by_what_holds_it
from kb_serve.recognise.likely.likely_values import value_there
from kb_serve.recognise.recognition import MissingName
from kb_serve.recognise.removed.removed_symbols import for_reading

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.by_words.operator_words import OperatorWords
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.likely.corrections import Corrector
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.old_code import OldCode, OldName
    from kb_serve.recognise.resolver import ResolvedChain, Resolver

_FEW = 3
_DEPRECATED = "Deprecated"  # in the description of what is on its way out, not of what it leads to
_FILE_ENDINGS = frozenset(
    "abc avi blend exr fbx glb gltf hdr jpg json mkv mov mp4 obj ply png py stl tif usd usdc vdb wav zip".split()  # noqa: SIM905
)
_CALLED = 0.9  # from here on, a named operator's or function's arguments may stand behind it
_BEHIND = 0.995  # what follows from a removed name's successor comes second
_NEARLY = 0.9  # from this similarity to a class on, a name is its misspelling, not a variable

_BEHIND_A_CALL = 0.05  # how much less sure than the function is what a path that it is given may mean
_BARE = 0.78  # how sure a class is with a call or an index behind it
_OF_NAMED = 0.86  # … what a name with ``_`` holds, behind what is called so
_MADE_BY_CALL = ("mathutils.", "bmesh.types.", TYPES)

# Python's own names, which are not Blender's API.
_NOT_API = frozenset({*dir(builtins), "NoneType"})
# Modules and classes that scripts use beside Blender's, and that nothing of Blender's is called by.
_OTHERS_MODULES = frozenset(
    {
        "Path", "argparse", "csv", "cv2", "datetime", "functools", "hashlib", "np", "numpy", "pd", "plt", "shutil",
        "struct", "subprocess", "tempfile", "textwrap", "threading", "torch", "traceback", "urllib", "uuid", "zipfile",
    }
)  # fmt: skip
_PYTHON_MODULES = {
    module.__name__: module for module in (itertools, json, logging, math, os, pathlib, random, re, sys, time)
}


def _is_api(chain: Chain) -> bool:
    """Whether a chain may be Blender's; ``object.location`` is, although Python has an ``object`` too, and so is
    ``math.operation``, which the module ``math`` lacks.
    """
    if chain.root in _PYTHON_MODULES and chain.attributes:
        return not hasattr(_PYTHON_MODULES[chain.root], chain.attributes[0])
    if chain.root in _OTHERS_MODULES:
        return False
    return chain.root not in _NOT_API or bool(chain.attributes)


def _is_file_name(chain: Chain) -> bool:
    """Whether a chain is a name and an ending that files have: ``file.blend``."""
    return len(chain.steps) == 1 and set(chain.attributes) <= _FILE_ENDINGS and chain.steps[0].kind == "attr"


def _is_named_after(chain: Chain, broken: ResolvedChain, resolved: ResolvedChain) -> bool:
    """Whether a variable is called as the very class that lacks what is read, of which the one that has it says less:
    ``layer_collection`` is no Collection. Or as scripts call that class, of which a property is set, and not the one
    that has it: ``node``.
    """
    usual = usual_classes(chain.root)
    is_set = chain.assigned and len(chain.steps) == 1 and broken.fit > resolved.fit
    if is_set and broken.symbols[0] in usual and resolved.symbols[0] not in usual:
        return True
    lacking, having = (key(reading.symbols[0].rpartition(".")[2]) for reading in (broken, resolved))
    return key(chain.root) == lacking != having and having in lacking


def _makes(chain: Chain, resolved: ResolvedChain) -> bool:
    """Whether a chain calls a class by its name: ``Euler((0, 0, 0), 'XYZ')``."""
    called = chain.steps[0].kind == "call" and chain.root[:1].isupper()
    return (
        called
        and resolved.symbols[0].endswith(f".{chain.root}")
        and resolved.symbols[0].startswith(_MADE_BY_CALL)
    )


def _arguments_of(symbol: Symbol | None) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """The arguments that something takes, each with its values."""
    parameters = symbol.parameters if symbol else ()
    return tuple((one.name, tuple(item.identifier for item in one.enum_items)) for one in parameters)


class Expressions:
    """Recognises code against one base."""

    def __init__(
        self,
        reader: BaseReader,
        resolver: Resolver,
        corrector: Corrector,
        old: OldCode,
        operators: OperatorWords,
    ) -> None:
        self._reader = reader
        self._operators = operators
        self._resolver = resolver
        self._corrector = corrector
        self._old = old
        self._custom = CustomProperties(reader)
        self._broken = BrokenExpressions(reader, resolver, old)
        self._beside = NamesBeside(reader, old)
        self._loose = LooseNames(reader, corrector)

    def recognise(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds what the expressions among ``chains`` resolve to, and what bare words name."""
        self._expressions(chains, recognition)
        self._paths_given(chains, recognition)
        self._beside.recognise(chains, recognition)

    def _taking(self, chain: Chain, readings: list[ResolvedChain]) -> list[ResolvedChain]:
        """Readings of a chain, of which the best leads to the case that takes what the chain is set to, or compared
        with: of ``ob.data.type == 'SPOT'`` a light's.
        """
        best = readings[0] if readings and chain.values and readings[0].alike else None
        if best is None or best.missing:
            return readings
        cases = ((path, self._reader.symbol(path)) for path in (best.symbols[-1], *best.alike))
        taking = [
            path
            for path, symbol in cases
            if symbol and any(item.identifier in chain.values for item in symbol.enum_items)
        ]
        if not taking:
            return readings
        symbols = (*best.symbols[:-1], taking[0])
        return [replace(best, symbols=symbols, alike=tuple(taking[1:])), *readings[1:]]

    def _expressions(self, chains: list[Chain], recognition: Recognition) -> None:
        code = [chain for chain in chains if chain.is_code and _is_api(chain)]
        if not code:
            return
        code.sort(key=lambda chain: chain.leads_on)
        prose = said_in_words(chains)
        are_several = len(code) > 1
        is_script = are_several and any(chain.steps or chain.assigned for chain in code)
        for position, chain in enumerate(_without_denied(code, recognition)):
            later = 0.02 * min(position, 5)
            readings = self._taking(chain, self._resolver.resolve(chain))
            if taken_as := self._old.still_taken(chain, readings):
                recognition.add_former_name(taken_as, 0.97 - later)
                continue
            variable = not chain.steps and (chain.assigned or are_several)
            if not variable and (old := self._old.in_chain(chain, readings)):
                if not chain.assigned:
                    old = replace(old, removed=for_reading(old.removed))
                self._old_name(old, later, recognition)
                self._new_value(chain, old, recognition)
                continue
            broken = likeliest_broken(chain, readings)
            # ``wm.append`` is an operator rather than whatever else can be appended to, and so is ``render.render``,
            # though some classes are called a little like it.
            told = readings and not (readings[0].fit < CLEAR and self._operator(chain))
            if told and self._trusted(chain, readings[0], broken) and not self._misspelt(chain, readings[0]):
                self._reading(chain, readings, later, recognition)
                is_doubted = broken and (
                    readings[0].fit < LIKELY or _is_named_after(chain, broken, readings[0])
                )
                if broken and is_doubted and not later and broken.fit >= CLEAR:
                    self._broken.tell_if(chain, broken, recognition)
            elif operator := self._operator(chain):
                recognition.add(operator.path, 0.97 - later, "expression")
            elif _is_file_name(chain) or self._is_argument(chain, recognition):
                continue
            elif not self._corrected(chain, readings, later, recognition):
                if broken:
                    self._broken.tell(chain, broken, later, recognition)
                is_own = not chain.steps or chain.steps[0].kind == "call"
                self._loose.recognise(chain, prose, recognition, is_variable=is_own and is_script)

    def _paths_given(self, chains: list[Chain], recognition: Recognition) -> None:
        """Adds what is wrong with the paths that are given to be animated, ``rotation`` of
        ``obj.keyframe_insert("rotation")``: as if each were read of the very thing.
        """
        for chain in chains:
            given = path_given(chain)
            readings = self._resolver.resolve(given) if given else []
            broken = likeliest_broken(given, readings) if given else None
            if given is None or broken is None:
                continue
            if old := self._old.in_chain(given, readings):
                self._old_name(old, _BEHIND_A_CALL, recognition)
            elif not any(one.complete and one.fit >= LIKELY * broken.fit for one in readings) and not (
                self._corrected(given, readings, _BEHIND_A_CALL, recognition)
            ):
                self._broken.tell(given, broken, _BEHIND_A_CALL, recognition)

    def _operator(self, chain: Chain) -> SymbolEntry | None:
        """The operator that a chain names without ``bpy.ops``: ``wm.append``."""
        return self._reader.entry(f"bpy.ops.{chain.dotted}") if chain.steps else None

    def _is_argument(self, chain: Chain, recognition: Recognition) -> bool:
        """Adds a name that stands behind an operator or function as an argument of it; whether it is one."""
        for match in recognition.matches if not chain.steps else ():
            symbol = self._reader.symbol(match.id) if match.sure >= _CALLED else None
            if symbol and any(parameter.name == chain.root for parameter in symbol.parameters):
                recognition.arguments.setdefault(match.id, []).append(chain.root)
                return True
        return False

    def _trusted(self, chain: Chain, resolved: ResolvedChain, broken: ResolvedChain | None) -> bool:
        """Whether a reading rests on more than a guess at what a variable or a bare word is.

        A variable clearly named after a class that lacks the attribute is one, not of another class that has it, if the
        class calls something so. So is one of a class that has it and lacks what follows.
        """
        if not resolved.complete or (_is_file_name(chain) and resolved.fit < LIKELY):
            return False
        if broken and self._lacks(chain, resolved, broken):
            return False
        if resolved.keyed and resolved.fit >= CLEAR:
            return True
        if is_socket(resolved.symbols[-1]) and (broken is None or broken.fit < CLEAR):
            return True  # what is in brackets tells it, whatever the variable is called
        return resolved.fit >= 1.0 or (bool(chain.attributes) and resolved.fit >= LEAST)

    def _lacks(self, chain: Chain, resolved: ResolvedChain, broken: ResolvedChain) -> bool:
        """Whether it is rather what the variable is named after that lacks what is asked of it than another thing that
        has it: it says so otherwise, or what holds such things does it.
        """
        is_only = len(chain.attributes) == 1
        missing = MissingName(broken.missing, broken.owner, called=chain.call is not None)
        if broken.fit >= CLEAR and resolved.fit < LIKELY:
            has_member = broken.steps_left < len(chain.steps)
            if has_member or (is_only and said_otherwise(missing, self._operators, self._reader)):
                return True
        # ``collection.remove(obj)``: much has such functions.
        is_likelier = resolved.fit < CLEAR * broken.fit and broken.fit >= LIKELY
        return is_only and is_likelier and bool(by_what_holds_it(broken.owner, broken.missing, self._reader))

    def _misspelt(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether a root is a misspelt class: ``PoimtLight`` is hardly a variable that holds a light."""
        if resolved.fit >= 1.0 or not chain.root[:1].isupper():
            return False
        meant = self._corrector.root(chain.root)
        return meant is not None and _NEARLY <= meant.similarity < 1.0

    def _old_name(self, old: OldName, later: float, recognition: Recognition) -> None:
        """Adds a removed symbol, and where the rest of its chain leads from what took its place."""
        for _ in range(_FEW):
            recognition.add_removed(old.removed)
            if not old.rest or not old.removed.targets:
                return
            resolved = self._resolver.onward(plain_path(old.removed.targets[0]), old.rest)
            if resolved.complete:
                recognition.add(resolved.symbols[-1], _BEHIND - later, "behind the successor")
                return
            further = self._old.behind(old.removed.path, resolved, old.rest)
            if further is None:
                return
            old = further

    def _new_value(self, chain: Chain, old: OldName, recognition: Recognition) -> None:
        """Tells what becomes of the text that a removed property is set to, where what took its place has another."""
        if not chain.assigned or len(chain.values) != 1 or old.rest or not old.removed.targets:
            return
        target = self._reader.symbol(old.removed.targets[0])  # none where the target is a value itself
        items = [item.identifier for item in target.enum_items] if target else []
        if said := value_there(chain.values[0], items):
            recognition.notes.append(f"`{as_code(old.removed.targets[0])}`: {said}")

    def _reading(
        self, chain: Chain, readings: list[ResolvedChain], later: float, recognition: Recognition
    ) -> None:
        """Adds the best readings of a chain, and the symbols on the way to the first."""
        is_sure = is_clear(chain, readings[0]) or self._agree(chain, readings)
        recognition.readings[chain.key] = readings[0].symbols[-1] if is_sure else ""
        bare = not chain.attributes and not readings[0].keyed  # a class with a call or an index behind it
        # ``active_object``: rather what is called so than what it holds
        is_name = (
            bare and not chain.steps and "_" in chain.root and bool(self._reader.names.by_name(chain.root))
        )
        likely = [
            resolved
            for resolved in readings[:4]
            if resolved.complete and resolved.fit >= LIKELY * readings[0].fit
        ]
        recognition.guesses[chain.key] = [resolved.symbols[-1] for resolved in likely]
        for rank, resolved in enumerate(likely):
            sure = _BARE if bare and chain.steps and not _makes(chain, resolved) else 0.97
            if is_name and key(resolved.symbols[-1].rpartition(".")[2]) != key(chain.root):
                sure = _OF_NAMED
            recognition.add(resolved.symbols[-1], sure - 0.04 * rank - later, "expression")
        if not later and not bare and len(chain.root) > 1:
            usual = usual_classes(chain.root)
            others = [
                resolved.symbols[-1]
                for resolved in likely[1:]
                if resolved.symbols[0] in usual or resolved.fit <= TOLD_BY_MEMBER
            ]
            told = dict.fromkeys((*likely[0].alike, *others))
            recognition.alike = [path for path in told if path != likely[0].symbols[-1]]
        if not later and not bare and (lost := self._old.alike(chain, readings)):
            recognition.alike_lost = chain.root, lost
        if readings[0].keyed:
            name = next(step.text for step in reversed(chain.steps) if step.kind == "key")
            is_set = chain.assigned and bool(chain.literal or chain.values)  # and not read by ``+=``
            recognition.notes.append(self._custom.note(readings[0].keyed, name, assigned=is_set))
        if former := self._old.beneath(chain, readings[0]):
            cls = former.path.rpartition(".")[0]
            recognition.notes.append(
                f"`{readings[0].symbols[-1]}` is another thing than `{cls}` had by that name until {former.last}: "
                f"that is `{former.targets[0]}` now."
            )
            recognition.add(former.targets[0], 0.97 - later, "successor")
        last = self._reader.symbol(readings[0].symbols[-1])
        own = chain.attributes[-1] if chain.attributes else ""
        if last and own not in {"", last.name} and (note := self._custom.on_operators(last, own)):
            recognition.notes.append(note)
        if last and (method := readings[0].method) and (note := note_on_method(last, method)):
            recognition.notes.append(note)
        for step, path in enumerate(reversed(readings[0].symbols[:-1])):
            recognition.add(path, 0.5 - 0.05 * step - later, "on the way")
            symbol = self._reader.symbol(path)
            if symbol and _DEPRECATED in symbol.description:
                recognition.notes.append(f"`{path}`: {symbol.description}")

    def _agree(self, chain: Chain, readings: Sequence[ResolvedChain]) -> bool:
        """Whether a variable is called and used as a collection is, and all that it may be takes the same arguments and
        values: ``attributes.new(…)``, of a mesh or of a point cloud.
        """
        best = readings[0]
        if best.fit < LEAST_OF_COLLECTION or best.symbols[0].rpartition(".")[2] != chain.root:
            return False
        likely = [one for one in readings if one.complete and one.fit >= LIKELY * best.fit]
        symbols = (self._reader.symbol(one.symbols[-1]) for one in likely)
        return len({_arguments_of(symbol) for symbol in symbols}) == 1

    def _corrected(
        self, chain: Chain, readings: list[ResolvedChain], later: float, recognition: Recognition
    ) -> bool:
        """Adds a chain with its misspelt names corrected; whether that is possible."""
        if not chain.steps and not chain.root[:1].isupper():
            return False
        corrected = self._corrector.corrected(chain, readings)
        if corrected is None:
            return False
        resolved, corrections = corrected
        recognition.corrections += corrections
        recognition.readings[chain.key] = resolved.symbols[-1] if is_clear(chain, resolved) else ""
        alike = min(correction.similarity for correction in corrections) ** 0.25
        # What is wrong in code is what is asked for, before what is right.
        sure = 0.93 * alike if resolved.fit < USUAL else 1.0 - 0.1 * (1 - alike)
        recognition.add(resolved.symbols[-1], sure - later, "correction")
        for step, symbol in enumerate(reversed(resolved.symbols[:-1])):
            recognition.add(symbol, 0.5 - 0.05 * step - later, "on the way")
        return True


def _without_denied(chains: Iterable[Chain], recognition: Recognition) -> Iterator[Chain]:
    """Chains without those that end with a name which a message denies to a class: the variable is of that class, and
    nothing else that has or had the name is meant. How the code uses it is kept.
    """
    denied = {missing.name: place for place, missing in enumerate(recognition.missing) if missing.sure}
    for chain in chains:
        name = chain.attributes[-1] if chain.attributes else ""
        if name not in denied:
            yield chain
            continue
        place = denied[name]
        recognition.missing[place] = replace(
            recognition.missing[place], assigned=chain.assigned, called=chain.call is not None
        )
