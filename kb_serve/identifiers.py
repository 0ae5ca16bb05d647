"""What a caller typed → the symbols and pages that it names.

Spellings, calls, expressions, error messages, enum values, addresses: everything that names something.
What only describes something is left to the search.
"""

from __future__ import annotations

import re

from kb_build.analysis import terms
from kb_serve.addresses import addressed
from kb_serve.chains import find_chains
from kb_serve.corrections import Corrector, Drifts, nearest
from kb_serve.enum_values import EnumValues
from kb_serve.expressions import Expressions
from kb_serve.identified import Identified, Missing
from kb_serve.messages import Messages, without_boilerplate
from kb_serve.reader import TYPES, Reader
from kb_serve.spellings import Spellings
from kb_serve.walk import Walker

_FILE_PATH = re.compile(r"""(?<!\[)(['"])[^'"\n]*/[^'"\n]*\1""")
_FEW = 3
_MANY = 12


class Identifier:
    """Recognises names against one base."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._walker = Walker(reader)
        self._corrector = Corrector(reader, self._walker)
        self._drifts = Drifts(reader)
        self._spellings = Spellings(reader, self._drifts)
        self._enum_values = EnumValues(reader)
        self._messages = Messages(reader, self._walker, self._drifts, self._enum_values)
        self._expressions = Expressions(reader, self._walker, self._corrector, self._drifts)

    def identify(self, query: str) -> Identified:
        """Everything that ``query`` names, surest first."""
        found = Identified()
        for identifier in addressed(query, self._reader):
            found.add(identifier, 1.0, "address")
        self._spellings.recognise(query, found)
        if found.best is None or found.best.sure < 1:
            self._messages.recognise(query, found)
            self._expressions.recognise(find_chains(_FILE_PATH.sub(" ", without_boilerplate(query))), found)
            self._enum_values.recognise(query, found)
            self._explain_missing(found)
        found.matches.sort(key=lambda match: -match.sure)
        return found

    def _explain_missing(self, found: Identified) -> None:
        """What stands in for names that do not exist: replacements of former ones, similar members."""
        for missing in found.missing:
            if missing.owner and (drift := self._drifts.of_member(missing.owner, missing.name)):
                found.drifts.append(drift)
        for place, drift in enumerate(found.drifts):
            for rank, (target, score) in enumerate(drift.instead):
                sure = max(0.74 + 0.2 * min(1.0, (score - 0.6) / 0.8), 0 if rank else 0.85)
                found.add(target, sure - 0.05 * min(place, 3), "replacement")
        for missing in found.missing:
            names = self._corrector.member_names(missing.owner) if missing.owner else []
            similar = nearest(missing.name, names)
            for name, alike in similar:
                if member := self._walker.member(missing.owner, name):
                    found.add(member.path, 0.95 * alike, "similar name")
            if missing.owner and not similar:
                self._elsewhere(missing, found)

    def _elsewhere(self, missing: Missing, found: Identified) -> None:
        """The same name on other classes, those called most alike first: ``CollectionObjects.link``."""
        rows = [
            entry
            for entry in self._reader.by_name(missing.name)
            if entry.group != "ui" and "." in entry.owner
        ]
        if not 0 < len(rows) <= _MANY:
            return
        about = set(terms(missing.owner.removeprefix(TYPES)))
        rows.sort(key=lambda entry: -len(about & set(terms(entry.owner.removeprefix(TYPES)))))
        for rank, entry in enumerate(rows[:_FEW]):
            found.add(entry.path, 0.82 - 0.03 * rank, "same name")
