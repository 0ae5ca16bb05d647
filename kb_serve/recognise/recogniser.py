"""Recognises the symbols and pages that a query names, in any form: a spelling, call, expression, error message,
enum value or URL. Descriptions are left to the search.
"""

from __future__ import annotations

import re

from kb_build.index.analysis import terms
from kb_serve.reader import TYPES, BaseReader
from kb_serve.recognise.addresses import ids_in_urls
from kb_serve.recognise.calls import NO_OVERRIDE, OVERRIDE, wrong_arguments
from kb_serve.recognise.chains import Chain, find_chains
from kb_serve.recognise.corrections import Corrector, RemovedSymbolLookup, nearest
from kb_serve.recognise.enum_values import EnumValues
from kb_serve.recognise.expressions import Expressions
from kb_serve.recognise.message_patterns import without_callers_names, without_wording
from kb_serve.recognise.messages import Messages
from kb_serve.recognise.recognition import MissingName, Recognition
from kb_serve.recognise.resolver import Resolver
from kb_serve.recognise.spellings import Spellings

_FILE_PATH = re.compile(r"""(?<!\[)(['"])[^'"\n/]*/[^'"\n]*\1""")
_FEW = 3
_SURE = 0.9
_MANY = 12
_OWNER_ALONE = 0.81  # how sure a class is whose member exists nowhere


def _name(chain: Chain) -> str:
    return chain.attributes[-1] if chain.attributes else chain.root


class Recogniser:
    """Recognises names against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._resolver = Resolver(reader)
        self._corrector = Corrector(reader, self._resolver)
        self._removed = RemovedSymbolLookup(reader)
        self._spellings = Spellings(reader, self._removed)
        self._enum_values = EnumValues(reader)
        self._messages = Messages(reader, self._resolver, self._removed, self._enum_values)
        self._expressions = Expressions(reader, self._resolver, self._corrector, self._removed)

    def recognise(self, query: str) -> Recognition:
        """Everything that ``query`` names, surest first."""
        recognition = Recognition()
        for identifier in ids_in_urls(query, self._reader):
            recognition.add(identifier, 1.0, "address")
        self._spellings.recognise(query, recognition)
        if recognition.best is None or recognition.best.sure < 1:
            self._messages.recognise(query, recognition)
            text = without_callers_names(without_wording(query))
            self._expressions.recognise(find_chains(_FILE_PATH.sub(" ", text)), recognition)
            self._enum_values.recognise(text, recognition)
            self._removed_values(text, recognition)
            self._messages.explain(query, recognition)
            self._explain_missing(recognition)
        self._check_calls(query, recognition)
        recognition.matches.sort(key=lambda match: -match.sure)
        return recognition

    def _check_calls(self, query: str, recognition: Recognition) -> None:
        """Adds notes on wrong arguments of the recognised calls."""
        if "(" not in query:
            return
        chains = [chain for chain in find_chains(query) if chain.steps and chain.steps[-1].kind == "call"]
        for chain in chains:
            paths = [
                match.id
                for match in recognition.matches
                if match.sure >= _SURE and match.id.endswith(f".{_name(chain)}")
            ]
            if paths and (symbol := self._reader.symbol(paths[0])):
                notes = list(wrong_arguments(chain, symbol))
                recognition.notes += notes
                if NO_OVERRIDE in notes and recognition.matches:
                    recognition.add(OVERRIDE, 0.85, "error message")

    def _removed_values(self, text: str, recognition: Recognition) -> None:
        """Adds enum items that a property in the query has only in other versions."""
        for value in self._enum_values.values(text):
            for match in [match for match in recognition.matches if match.sure >= _SURE]:
                if removed := self._removed.of_path(f"{match.id}:{value}"):
                    recognition.removed.append(removed)

    def _explain_missing(self, recognition: Recognition) -> None:
        """Adds replacements for names that do not exist: of removed symbols, and similar members."""
        for missing in recognition.missing:
            if missing.owner and (removed := self._removed.of_member(missing.owner, missing.name)):
                recognition.removed.append(removed)
        for place, removed in enumerate(recognition.removed):
            for rank, (target, score) in enumerate(removed.instead):
                sure = max(0.74 + 0.2 * min(1.0, (score - 0.6) / 0.8), 0 if rank else 0.85)
                recognition.add(target, sure - 0.05 * min(place, 3), "replacement")
        for missing in recognition.missing:
            names = self._corrector.member_names(missing.owner) if missing.owner else []
            similar = nearest(missing.name, names)
            if missing.assigned:  # an assignment means ``select_set``, not ``select_get``
                similar.sort(
                    key=lambda row: (-row[1], not row[0].startswith("set_") and not row[0].endswith("_set"))
                )
            for place, (name, alike) in enumerate(similar):
                if member := self._resolver.member(missing.owner, name):
                    recognition.add(member.path, 0.95 * alike - 0.01 * place, "similar name")
            if missing.owner and not similar and not self._elsewhere(missing, recognition):
                recognition.add(missing.owner, _OWNER_ALONE, "owner")

    def _elsewhere(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the name on other classes (``CollectionObjects.link``), similar ones first; whether there is any."""
        rows = [
            entry
            for entry in self._reader.by_name(missing.name)
            if entry.group != "ui" and "." in entry.owner
        ]
        if not 0 < len(rows) <= _MANY:
            return False
        about = set(terms(missing.owner.removeprefix(TYPES)))
        rows.sort(key=lambda entry: -len(about & set(terms(entry.owner.removeprefix(TYPES)))))
        for rank, entry in enumerate(rows[:_FEW]):
            recognition.add(entry.path, 0.82 - 0.03 * rank, "same name")
        return True
