"""Finds the removed names that code has in texts and imports: classes, operators, properties and modules."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import OPERATORS, TYPES, interface_part
from kb_build.symbols.flags import NODE_FAMILIES
from kb_build.symbols.paths import last_name
from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.removed.old_code import WORDS_OF_CLASS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.removed.old_code import OldCode
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup
    from kb_serve.recognise.resolver import Resolver

_CLASS_NAME = re.compile(rf"""(["'])({WORDS_OF_CLASS.pattern})\1""")  # not ``"Lamp"``, an object's name
_OPERATOR_NAME = re.compile(r"""(["'])([a-z]\w*\.[a-z]\w+)\1""")
# A property named in a string: ``layout.prop(ob, "name")``, ``getattr(ob, "name")``, ``ob.keyframe_insert("name")``.
_PROPERTY_NAMES = (
    re.compile(r"""\b(?:prop|prop_search|[gs]etattr|hasattr)\(\s*([A-Za-z_][\w.]*)\s*,\s*["'](\w+)["']"""),
    re.compile(
        # Only from the start of a dotted name: trying each part of a long one takes seconds.
        r"""(?<![\w.])([A-Za-z_][\w.]*)\.(?:keyframe_(?:insert|delete)|driver_(?:add|remove)|property_unset)\("""
        r"""\s*(?:(?:data_)?path\s*=\s*)?["'](\w+)["']"""
    ),
)
_IMPORT = re.compile(r"\bimport\s+([a-z_][\w.]*(?:\s*,\s*[a-z_][\w.]*)*)")
_FROM = re.compile(r"\bfrom\s+([a-z][\w.]*)\s+import\s+\(?\s*(\w+(?:\s*,\s*\w+)*)")
_KEYWORD = re.compile(r"""\W*(\w+)\s*=\s*(['"])([A-Z][A-Z0-9_]+)\2\W*""")  # alone
_MOST_QUOTED = 12


class OldTexts:
    """Finds them against one base."""

    def __init__(
        self, reader: BaseReader, resolver: Resolver, removed: RemovedSymbolLookup, old: OldCode
    ) -> None:
        self._reader = reader
        self._resolver = resolver
        self._removed = removed
        self._old = old

    def in_imports(self, text: str) -> Iterator[RemovedSymbol]:
        """Removed modules, and removed names of modules, that are imported."""
        paths = [name.strip() for match in _IMPORT.finditer(text) for name in match[1].split(",")]
        for match in _FROM.finditer(text):
            paths += [match[1], *(f"{match[1]}.{name.strip()}" for name in match[2].split(","))]
        for path in paths[:_MOST_QUOTED]:
            if removed := self._removed.of_path(path) or self._removed.of_path(path.partition(".")[0]):
                yield removed

    def in_keyword(self, text: str) -> Iterator[RemovedSymbol]:
        """The value that an argument lost which is all of a text, ``icon='LAMP'``: of the function that counts most.

        Nothing where something of that name takes it today.
        """
        match = _KEYWORD.fullmatch(text) if _has_quotes(text) else None
        if match is None:
            return
        today = (
            owner for owner, item, _ in self._reader.names.enum_owners(key(match[3])) if item == match[3]
        )
        if any(owner.endswith((f"({match[1]})", f".{match[1]}")) for owner in today):
            return
        end = f"({match[1]}):{match[3]}"
        paths = [path for path in self._reader.history.removed_named(match[3]) if path.endswith(end)]
        found = [one for one in map(self._removed.of_path, paths) if one and one.targets]
        weights = self._reader.usage.weights([one.path.removesuffix(end) for one in found])
        found.sort(key=lambda one: -weights.get(one.path.removesuffix(end), 0.0))
        yield from found[:1]

    def still_taken_in_strings(self, text: str) -> Iterator[str]:
        """The classes that one gets by former names which are quoted: ``nodes.new("ShaderNodeBsdfGlossy")``."""
        if not _has_quotes(text):
            return
        yield from filter(None, map(self._reader.history.still_works, _quoted_paths(text)))

    def in_strings(self, text: str) -> Iterator[RemovedSymbol]:
        """Removed classes, operators and properties whose names are quoted: ``nodes.new("ShaderNodeTexMusgrave")``."""
        if not _has_quotes(text):
            return
        quoted = filter(None, map(self._removed.of_path, _quoted_paths(text)))
        yield from (removed for removed in quoted if removed.targets or _is_given_as_text(removed.path))
        for pattern in _PROPERTY_NAMES:
            for match in islice(pattern.finditer(text), _MOST_QUOTED):
                for chain in find_chains(f"{match[1]}.{match[2]}")[:1]:
                    if old := self._old.in_chain(chain, self._resolver.resolve(chain), is_quoted=True):
                        yield old.removed


def _is_given_as_text(path: str) -> bool:
    """Whether scripts give such a class or operator by its name in a text: not ``LocRotScale``, a keying set's."""
    name = last_name(path)
    return path.startswith(OPERATORS) or name.startswith(NODE_FAMILIES) or bool(interface_part(name))


def _has_quotes(text: str) -> bool:
    return "'" in text or '"' in text


def _quoted_paths(text: str) -> Iterator[str]:
    """The paths of classes and operators whose names are quoted."""
    for pattern, prefix in ((_CLASS_NAME, TYPES), (_OPERATOR_NAME, OPERATORS)):
        for match in islice(pattern.finditer(text), _MOST_QUOTED):
            yield prefix + match[2]
