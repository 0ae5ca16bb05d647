"""Checks scripts: reads them as text, analyses them for one Blender, and asks every rule."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.analysis import analyse, analyse_files
from kb_build.flow.api import Api
from kb_build.flow.symbols import BaseSymbols
from kb_check.findings import Finding, Span
from kb_check.known_names import KnownNames
from kb_check.package import Package
from kb_check.rule import all_rules
from kb_check.script import Script
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping
    from pathlib import Path
    from typing import Self

    from kb_build.flow.analysis import Analysis

SYNTAX = "syntax-error"
INCOMPLETE = "incomplete"
_IGNORE = re.compile(r"#\s*simworlds:\s*ignore(?:\[(?P<rules>[\w\s,-]*)\])?")


@dataclass(frozen=True, slots=True)
class Read:
    """A script that was read, before the rules are asked: what the package registers must be known first."""

    code: str
    analysis: Analysis


class Checker:
    """Checks scripts against one base. Raises BaseMissing or BaseUnreadable when it cannot be opened."""

    def __init__(self, base: Path) -> None:
        self._reader = BaseReader(base)
        self._symbols = BaseSymbols(base)
        self.api = Api(self._symbols)
        self.names = KnownNames(self._reader)
        self.version = tuple(int(part) for part in self._reader.meta["blender"].split(".")[:3])

    def read(self, code: str) -> Read:
        """Reads a script. Nothing is imported or run; bad input of every kind ends in a finding."""
        return Read(code, analyse(code, self.api, self.version))

    def read_files(self, files: Mapping[str, str]) -> dict[str, Read]:
        """Reads the files of one package, so that types flow between them.

        ``files`` is path → text; paths use slashes and begin with the package's folder (``addon/ui/panels.py``).
        """
        found = analyse_files(files, self.api, self.version)
        return {path: Read(files[path], analysis) for path, analysis in found.items()}

    def check_files(self, files: Mapping[str, str], rules: Collection[str] = ()) -> dict[str, list[Finding]]:
        """The findings in the files of one package (see :meth:`read_files`), by path."""
        reads = self.read_files(files)
        package = self.package()
        for read in reads.values():
            package.add(read.analysis)
        return {path: self.check(read, package, rules) for path, read in reads.items()}

    def check(
        self, code: str | Read, package: Package | None = None, rules: Collection[str] = ()
    ) -> list[Finding]:
        """The findings in a script, in order. ``package`` is what it and the files beside it register."""
        read = self.read(code) if isinstance(code, str) else code
        analysis = read.analysis
        if analysis.tree is None:
            return [_unreadable(read.code, analysis.error)]
        if package is None:
            package = self.package()
            package.add(analysis)
        script = Script(read.code, analysis.tree, analysis, self.api, self.names, package, self.version)
        chosen = [rule for rule in all_rules().values() if not rules or rule.id in rules]
        found = [finding for rule in chosen for finding in rule.check(script)]
        if not analysis.complete:
            found.append(
                Finding(
                    INCOMPLETE, "note", Span(1, 0, 1, 0), "The script is too large: only a part was read."
                )
            )
        return sorted(_kept(found, script), key=lambda one: (one.span.line, one.span.column, one.rule))

    def package(self) -> Package:
        """An empty package, for this Blender's classes."""
        return Package(self.api)

    def close(self) -> None:
        """Closes the base."""
        self._reader.close()
        self._symbols.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _unreadable(code: str, error: SyntaxError | None) -> Finding:
    line, column = (error.lineno or 1, max((error.offset or 1) - 1, 0)) if error else (1, 0)
    message = error.msg if error and error.lineno else str(error)
    if re.search(r"^[ \t]*(print|exec)[ \t]+[^(\s=]", code, re.MULTILINE):
        message += ". The script looks like Python 2, which Blender took until 2.49."
    return Finding(SYNTAX, "error", Span(line, column, line, column), f"Python cannot read this: {message}")


def _kept(findings: list[Finding], script: Script) -> Iterator[Finding]:
    """The findings that no comment on their line ignores."""
    for finding in findings:
        lines = script.lines[finding.span.line - 1 : finding.span.end_line]
        if not any(_ignores(line, finding.rule) for line in lines):
            yield finding


def _ignores(line: str, rule: str) -> bool:
    found = _IGNORE.search(line)
    if found is None:
        return False
    rules = found["rules"]
    return rules is None or rule in {name.strip() for name in rules.split(",")}
