"""Recognises messages of modules, and names in modules, that cannot be imported."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.chains.chain_starts import ROOTS
from kb_serve.recognise.messages.guides import EXTENSIONS, ON_WHEELS, add_guide
from kb_serve.recognise.messages.nameless.files import NO_SUCH_ADDON
from kb_serve.recognise.messages.of_older import of_older

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_IMPORTABLE = frozenset({"class", "function", "data"})
_IMPORTED = "`{name}` must be imported first: `{how}`."
_OWN_NAME = (
    "The script uses `{name}` before it sets, defines or imports it, or spells it otherwise there: Blender gives it no "
    "such name."
)
_SHORTEST = 2  # letters of a name in ``math`` that scripts import by itself
_NOT_BLENDERS = {"np": "import numpy as np", "numpy": "import numpy", "Path": "from pathlib import Path"}
_BROUGHT = (
    "Blender's Python has no `{name}`: an extension brings a package as a wheel, named in its manifest. A file of the "
    "add-on's own is imported from its folder, `from . import {name}`."
)
_ENABLED_BY = "bpy.ops.preferences.addon_enable"
_ENABLING = "addon_enable("
_HAS_FILE = "SELECT 1 FROM uses WHERE file = ? OR file LIKE ? LIMIT 1"


class Imports:
    """Finds what cannot be imported from one base's Blender."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what other versions had of it."""
        for match in forms.first_matches(forms.NO_MODULE, query):
            if _ENABLING in query:  # which names no package that a script lacks
                recognition.add(_ENABLED_BY, 0.97, "error message")
                recognition.notes.append(NO_SUCH_ADDON)
            elif note := self._of_older(match["module"]):
                recognition.notes.append(note)
            elif not self.tell_if_gone(match["module"], recognition):
                self._tell_if_renamed(match["module"], recognition)
                self._tell_how_brought(match["module"], recognition)
        for match in forms.first_matches(forms.NO_IMPORT, query):
            self.tell_if_gone(f"{match['module']}.{match['name']}", recognition)
        for match in forms.first_matches(forms.NOT_DEFINED, query):
            self._tell_where(match["name"], recognition)

    def _of_older(self, module: str) -> str:
        """That this Blender has a module which that of a message has not yet; empty where it is no newer one."""
        entry = self._reader.entry(module)
        return of_older(module, self._reader) if entry and entry.kind == "module" else ""

    def _tell_if_renamed(self, module: str, recognition: Recognition) -> None:
        """What Blender calls one of its internal modules now, where it is not known since when: with an underscore."""
        files = (f"modules/_{module}.py", f"modules/_{module}/%")
        if "." not in module and self._reader.rows(_HAS_FILE, *files):
            recognition.notes.append(
                f"`{module}` is one of Blender's internal modules, which have an underscore now: `import _{module}`. "
                "They change without notice."
            )

    def _tell_how_brought(self, module: str, recognition: Recognition) -> None:
        """How an add-on brings a module that is neither Blender's nor Python's."""
        package = module.partition(".")[0]
        is_known = package in sys.stdlib_module_names or self._reader.entry(package) is not None
        of_blender = (
            f"addons_core/{package}.py",
            f"addons_core/{package}/%",
        )  # an add-on that is not enabled
        if is_known or not self._reader.entry(EXTENSIONS) or self._reader.rows(_HAS_FILE, *of_blender):
            return
        add_guide(ON_WHEELS, self._reader, recognition, 0.9)
        recognition.notes.append(_BROUGHT.format(name=package))

    def _tell_where(self, name: str, recognition: Recognition) -> None:
        """Where a name is imported from that a script uses without having done so."""
        meant = ROOTS.get(name, name)
        if meant != name:
            recognition.add(meant, 0.97, "error message")
            recognition.notes.append(f"A script has no `{name}` of its own: write `{meant}`.")
            return
        entry = self._public(name)
        if entry is None:
            recognition.notes.append(_of_python(name) or _OWN_NAME.format(name=name))
            recognition.says_all = True
            return
        recognition.add(entry.path, 0.98, "error message")
        how = f"import {name}" if entry.kind == "module" else f"from {entry.owner} import {name}"
        recognition.notes.append(_IMPORTED.format(name=name, how=how))

    def _public(self, name: str) -> SymbolEntry | None:
        """The module of that name, or what a module has of it that counts most; None for a name that tells nothing."""
        entry = self._reader.entry(name)
        if entry and entry.kind == "module":
            return entry
        if name.islower() and "_" not in name:
            return None
        named = [entry for entry in self._reader.names.by_name(name) if entry.kind in _IMPORTABLE]
        owners = {entry: self._reader.entry(entry.owner) for entry in named}
        public = [entry for entry, owner in owners.items() if owner and owner.kind == "module"]
        return next(iter(self._reader.usage.heaviest(public)), None)

    def tell_if_gone(self, path: str, recognition: Recognition) -> bool:
        """Adds a module, or a name in one, that only other versions have; returns whether it is one."""
        removed = None if self._reader.entry(path) else self._removed.of_path(path)
        if removed:
            recognition.add_removed(removed)
        return removed is not None


def _of_python(name: str) -> str:
    """How a name is imported that is Python's own, or of a package that comes with Blender; empty for others."""
    how = _NOT_BLENDERS.get(name, "")
    if not how and name in sys.stdlib_module_names:
        how = f"import {name}"
    if not how and len(name) >= _SHORTEST and hasattr(math, name):
        how = f"from math import {name}"
    return _IMPORTED.format(name=name, how=how) if how else ""
