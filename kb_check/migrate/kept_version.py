"""Older Blenders in which the migrated script must still run: what of the new form they have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.paths import argument_of, plain_path, split_path
from kb_check.migrate.place import version_of

if TYPE_CHECKING:
    from kb_check.checker import Checker
    from kb_check.migrate.change import Change, Version
    from kb_serve.reader import BaseReader


@dataclass(frozen=True, slots=True)
class KeptVersion:
    """A Blender that the script must keep working in; ``checker`` is of its base, None where there is none.

    ``histories`` are bases of other Blenders: they know what older ones had.
    """

    version: Version
    checker: Checker | None = None
    histories: tuple[BaseReader, ...] = ()

    @property
    def name(self) -> str:
        """The version as people write it."""
        return ".".join(map(str, self.version))

    def takes(self, change: Change, target: BaseReader) -> bool:
        """Whether this Blender takes a change's new form; ``target`` knows since when its symbols are there."""
        if self.version >= change.since:
            return True
        return bool(change.targets) and all(self._has(path, target) for path in change.targets)

    def came_later(self, path: str, target: BaseReader) -> str:
        """The first Blender that is known to have a symbol, where this one is known to be too old for it; else "".

        Of what is in a class that came later, too, nothing is known: the class may have had another name before.
        """
        gone = target.history.removed(path)
        first, lacked = (gone[0], "") if gone else target.history.arrival(path)
        if not first or version_of(first) <= self.version or (lacked and version_of(lacked) < self.version):
            return ""
        if _known(self.checker, path) if self.checker is not None else self._had(path):
            return ""
        return "" if self._is_in_newer(path, target) else first

    def _is_in_newer(self, path: str, target: BaseReader) -> bool:
        """Whether anything that a symbol belongs to came later, too."""
        while path := split_path(path)[0]:
            since = target.history.arrival(path)[0]
            if since and version_of(since) > self.version:
                return True
        return False

    def _has(self, path: str, target: BaseReader) -> bool:
        if self.checker is not None:
            return _known(self.checker, path)
        if self._had(path):
            return True
        # Without a base, what the history tells: of arguments, values and sockets it tells too little.
        if any(mark in path for mark in '([:"'):
            return False
        since = target.history.arrival(path)[0] or target.history.arrival(path.rpartition(".")[0])[0]
        return not since or version_of(since) <= self.version

    def _had(self, path: str) -> bool:
        """Whether a later Blender that lacks a symbol knows that this one had it."""
        spans = (reader.history.removed(path) for reader in self.histories)
        return any(
            span[0] and version_of(span[0]) <= self.version <= version_of(span[1]) for span in spans if span
        )


def _known(checker: Checker, path: str) -> bool:
    """Whether a Blender has a symbol, an argument ``f(x)``, a value ``p:X`` or a socket."""
    reader, symbols = checker.names.reader, checker.api.symbols
    if '["' in path:
        return symbols.symbol(path) is not None or bool(reader.history.still_works(path))
    owner, mark, value = split_path(path)
    if mark == ":":
        return value in checker.api.values_of(owner)
    symbol, parameter = symbols.symbol(plain_path(path)), argument_of(path)
    if symbol is None:
        return False
    return not parameter or any(known.name == parameter for known in symbol.parameters)
