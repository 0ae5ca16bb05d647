"""Checks scripts: reads them as text, analyses them for one Blender, and asks every rule."""

from __future__ import annotations

import ast
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.flow.analysis import Analysis, analyse, analyse_files
from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import MOST_KEPT, BaseSymbols
from kb_build.flow.syntax.parse import too_long
from kb_check.names.known import KnownNames
from kb_check.registered.package import Package
from kb_check.rule import all_rules, rule_named
from kb_check.script import Script
from kb_check.text.ignores import UNUSED, Ignores
from kb_check.text.salvage import salvage
from kb_serve.reader import BaseReader
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping
    from pathlib import Path
    from typing import Self

    from kb_check.findings import Finding


@dataclass(frozen=True, slots=True)
class Read:
    """A script that was read, before the rules are asked: what the package registers must be known first.

    ``error`` says why Python cannot parse it; the analysis is then of what could be read all the same, and
    ``may_register`` are names that the rest may define. ``path`` is the file's, as :meth:`Checker.read_files` got it.
    """

    code: str
    analysis: Analysis
    error: SyntaxError | None = None
    may_register: frozenset[str] = frozenset()
    path: str = ""

    @property
    def tree(self) -> ast.Module:
        """The part that could be parsed."""
        return self.analysis.tree or ast.Module([], [])


class Checker:
    """Checks scripts against one base. Raises BaseMissing or BaseUnreadable when it cannot be opened.

    ``base`` is the file, or what reads it for others as well, who close it. ``kept``: how many look-ups of each kind
    are kept in memory.
    """

    def __init__(self, base: Path | BaseReader, kept: int = MOST_KEPT) -> None:
        with ExitStack() as opened:
            reader = base if isinstance(base, BaseReader) else opened.enter_context(closing(BaseReader(base)))
            symbols = opened.enter_context(closing(BaseSymbols(reader.path, kept)))
            self._opened = opened.pop_all()
        self.names = KnownNames(reader)
        self.api = Api(symbols, self.names)
        self.version = version_key(reader.meta["blender"])

    def read(self, code: str) -> Read:
        """Reads a script. Nothing is imported or run; bad input of every kind ends in a finding."""
        if too_long(code):
            return Read(code, Analysis(None, {}, {}, complete=False))
        analysis = analyse(code, self.api, self.version)
        if analysis.tree is not None:
            return Read(code, analysis)
        part = salvage(code)
        return Read(code, analyse(part.code, self.api, self.version), analysis.error, part.registered_names)

    def read_files(self, files: Mapping[str, str]) -> dict[str, Read]:
        """Reads the files of one package, so that types flow between them.

        ``files`` is path → text; paths use slashes and begin with the package's folder (``addon/ui/panels.py``).
        """
        found = analyse_files(files, self.api, self.version)
        return {
            path: replace(self.read(files[path]), path=path)
            if analysis.tree is None
            else Read(files[path], analysis, path=path)
            for path, analysis in found.items()
        }

    def check(
        self, code: str | Read, package: Package | None = None, rules: Collection[str] = ()
    ) -> list[Finding]:
        """The findings in a script, in order. ``package`` is what it and the files beside it register; ``rules`` are
        the ids of those that are checked, by default of all.
        """
        read = self.read(code) if isinstance(code, str) else code
        if package is None:
            package = self.package([read])
        script = self.script(read, package)
        asked = map(rule_named, rules) if rules and UNUSED not in rules else all_rules().values()
        found = [finding for rule in asked for finding in rule.check(script)]
        found = [finding for finding in found if not script.is_doubted(finding.span)]
        ignores = Ignores(read.code)
        kept = ignores.kept(found)
        if read.error is None and read.analysis.complete and (not rules or UNUSED in rules):
            kept += ignores.kept(list(ignores.unused(all_rules())))
        chosen = [finding for finding in kept if not rules or finding.rule in rules]
        return sorted(chosen, key=lambda one: (one.span.line, one.span.column, one.rule))

    def script(self, read: Read, package: Package) -> Script:
        """A script that was read, as the rules see it."""
        return Script(
            read.code,
            read.tree,
            read.analysis,
            self.api,
            self.names,
            package,
            self.version,
            read.error,
            read.path,
        )

    def package(self, reads: Iterable[Read] = ()) -> Package:
        """What files register together, for this Blender's classes."""
        package = Package(self.api)
        for read in reads:
            package.add(read.analysis, read.may_register, read.path)
        return package

    def close(self) -> None:
        """Closes the base."""
        self._opened.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
