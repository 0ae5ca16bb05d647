"""Reads imports: of the API's modules, of the files that are analysed together, and of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import API_MODULES, LOST_MODULES
from kb_build.flow.evaluation.members import Members
from kb_build.flow.values.types import UNKNOWN, LocalModule, Module, Type

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterable


class Imports(Members):
    """Reads ``import`` and ``from ... import``; each reader tells whether the next statement can be reached."""

    def read_import(self, node: ast.Import) -> bool:
        """Reads ``import a.b as c``."""
        for alias in node.names:
            top = alias.name.partition(".")[0]
            known = top in API_MODULES
            whole = self._module(alias.name) if known else UNKNOWN
            if known and whole is UNKNOWN and "." in alias.name:
                self.resolve(alias, "name", alias.name, missing=(alias.name,))
            elif known:
                self.resolve(alias, "name", alias.name, (alias.name,))
            if not known:
                whole = self._other_module(alias.name)
                self._tell_lost(alias, alias.name)
            if alias.asname:
                self.bind(alias.asname, whole)
            else:
                self.bind(top, self._module(top) if known else self._other_module(top))
        return True

    def read_import_from(self, node: ast.ImportFrom) -> bool:
        """Reads ``from a import b as c``."""
        module = node.module or ""
        known = not node.level and module.partition(".")[0] in API_MODULES
        owner = (
            self._module(module) if known else self._other_module(self.here.file.imported(node.level, module))
        )
        if not known and not node.level:
            self._tell_lost(node, module)
        for alias in node.names:
            name = alias.asname or alias.name
            if alias.name == "*":
                self._import_all(owner)
                continue
            if owner is UNKNOWN:
                self.bind(name, UNKNOWN)
                continue
            found = self.attribute(owner, alias.name)
            if found.symbols or found.missing:
                self.resolve(alias, "name", alias.name, found.symbols, found.missing)
            self.bind(name, found.type)
        return True

    def _import_all(self, owner: Type) -> None:
        names: Iterable[str] = ()
        if isinstance(owner, Module):
            names = self.api.own(owner.path)
        elif isinstance(owner, LocalModule) and (file := self.files.get(owner.name)):
            names = list(file.module.ever)
        for name in names:
            if not name.startswith("_"):
                self.bind(name, self.attribute(owner, name).type)

    def _other_module(self, name: str) -> Type:
        """A module of the files that are analysed together, or else of Python's library."""
        found = self.local_module(name)
        return self.of_python(name) if found is UNKNOWN else found

    def _module(self, path: str) -> Type:
        symbol = self.api.symbols.symbol(path)
        if symbol is None:
            return UNKNOWN
        owner, _, name = path.rpartition(".")
        member = self.api.member(owner, name) if owner else None
        return member.type if member else Module(path)

    def _tell_lost(self, node: ast.AST, module: str) -> None:
        """Records an imported module that other Blenders bring and this one does not, unless the files have it."""
        top = module.partition(".")[0]
        if top in LOST_MODULES:
            is_lost = self.version >= LOST_MODULES[top][0] and not self._may_bring(top)
        else:
            is_lost = self.api.had("", top)
        if is_lost and self.local_module(top) is UNKNOWN:
            self.resolve(node, "name", top, missing=("",))

    def _may_bring(self, module: str) -> bool:
        """Whether a module may be one that stands beside the scripts, or where they say that others are."""
        beside = any(module in name.split(".") for name in (*self.files, *self.folders))
        return beside or any(file.moves_imports for file in self.sources)
