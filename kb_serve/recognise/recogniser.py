"""Recognises the symbols and pages that a query names, in any form: a spelling, call, expression, error message,
enum value or URL. Descriptions are left to the search.
"""

from __future__ import annotations

import re
from bisect import bisect
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, tokens
from kb_build.symbols.api_names import COLLECTION, TYPES
from kb_build.symbols.paths import last_name, plain_path, socket_node
from kb_serve.recognise.by_words.menus_by_words import menu_extended
from kb_serve.recognise.by_words.operator_words import OperatorWords
from kb_serve.recognise.chains.bindings import with_bindings
from kb_serve.recognise.chains.chains import Chain, find_chains
from kb_serve.recognise.chains.subscripts import asked_of_inputs
from kb_serve.recognise.code.expressions import Expressions
from kb_serve.recognise.code.operator_properties import explain_properties
from kb_serve.recognise.code.own_names import own_names
from kb_serve.recognise.code.uses import Uses, is_other_enum
from kb_serve.recognise.likely.corrections import Corrector
from kb_serve.recognise.message_patterns import (
    BAD_ENUM,
    classes_of_things,
    is_message,
    items_listed,
    members_named,
    says_what_failed,
    without_callers_names,
    without_values,
    without_wording,
)
from kb_serve.recognise.messages.messages import Messages
from kb_serve.recognise.missing_names import MissingNames
from kb_serve.recognise.named.addresses import ids_in_urls
from kb_serve.recognise.named.enum_values import EnumValues
from kb_serve.recognise.named.newer_nodes import (
    name_on_an_old_node,
    tell_of_the_newer_mix,
    tell_of_the_newer_node,
)
from kb_serve.recognise.named.spellings import Spellings
from kb_serve.recognise.recognition import Recognition
from kb_serve.recognise.removed.lost_values import LostValues
from kb_serve.recognise.removed.old_code import OldCode
from kb_serve.recognise.removed.old_texts import OldTexts
from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup
from kb_serve.recognise.resolver import Resolver

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.code.own_names import OwnNames

# What the panels of render engines name engines by, whether this Blender has them or not: none is set.
_FOR_ENGINES = re.compile(r"\bCOMPAT_ENGINES\s*=\s*[{(\[][^})\]]*")
# In which classes are that scripts import by name.
_PACKAGES = (TYPES, "mathutils.", "bmesh.types.")
_FILE_PATH = re.compile(r"""(?<!\[)(['"])[^'"\n/]*/[^'"\n]*\1""")
_FEW = 3
_SURE = 0.9
_TOLD = 0.98  # how sure what a message names is
_DESCRIBED = 0.85  # how sure is what plain words describe
_OWNER_OF_REMOVED = 0.85  # … a class whose removed member has no known successor
# Of names that resemble a removed one: how sure those are from a score on; half of these are its successors, of the
# others a quarter, and as many have none (found by comparing the guesses with the table of successors).
_LIKELY = 1.1
_LIKELY_GUESS = 0.88
_GUESS = 0.83
_UNKNOWN_MODULE = (
    "The build of Blender {version} behind this base has no module `{module}`; other builds may have it."
)
_OF_STRINGS = frozenset({"enum item", "quoted name"})
_GUESSES = _OF_STRINGS | {"name", "label", "title", "on the way"}


def _outside_of_paths(text: str) -> list[Chain]:
    """The chains of a text but for those in the paths of files: ``wood.png`` of ``"//textures/wood.png"``."""
    paths = [match.span() for match in _FILE_PATH.finditer(text)]
    begins = [begin for begin, _ in paths]
    found: list[Chain] = []
    end = 0
    for chain in find_chains(text):
        start = text.find(chain.source, end)
        end = start + len(chain.source)
        before = bisect(begins, start) - 1
        if before < 0 or start >= paths[before][1]:
            found.append(chain)
    return found


def _is_told(value: str, recognition: Recognition) -> bool:
    """Whether it is already known of an enum item that it was removed."""
    return any(removed.path.endswith(f":{value}") for removed in recognition.removed)


class Recogniser:
    """Recognises names against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        resolver = Resolver(reader)
        self._removed = RemovedSymbolLookup(reader)
        self._spellings = Spellings(reader, self._removed)
        self._enum_values = EnumValues(reader)
        self._messages = Messages(reader, self._removed, self._enum_values)
        self._lost_values = LostValues(reader, self._removed)
        old = OldCode(reader, self._removed)
        old_texts = OldTexts(reader, resolver, self._removed, old)
        operators = OperatorWords(reader)
        self._expressions = Expressions(reader, resolver, Corrector(reader, resolver), old, operators)
        self._uses = Uses(reader, resolver, self._enum_values, old_texts, self._lost_values)
        self._missing = MissingNames(reader, operators)

    def recognise(self, query: str) -> Recognition:
        """Everything that ``query`` names, surest first."""
        query = _FOR_ENGINES.sub("COMPAT_ENGINES", query)
        recognition = Recognition()
        own = own_names(query, self._is_of_blender)
        chains = own.without(with_bindings(query, find_chains(query)))
        recognition.notes += (
            _UNKNOWN_MODULE.format(version=self._reader.meta.get("minor", ""), module=module)
            for module in sorted(self._reader.history.unknown_modules.intersection(tokens(query)))
        )
        for identifier in ids_in_urls(query, self._reader):
            recognition.add(identifier, 1.0, "address")
        self._spellings.recognise(query, recognition)
        is_settled = recognition.best is not None and recognition.best.sure >= 1
        if not is_settled:
            self._read(query, chains, own, recognition)
        self._uses.check(query, chains, recognition)
        if not is_settled:
            self._values_of_nothing(query, recognition)
        self._messages.explain(query, recognition)
        explain_properties(chains, recognition, self._removed, self._reader)
        old = next((match.id for match in recognition.matches if match.sure >= _SURE), "")
        if (name := name_on_an_old_node(old)) and last_name(socket_node(old)) not in query:
            tell_of_the_newer_node(name, self._reader, recognition)
        tell_of_the_newer_mix(old, self._reader, recognition)
        self._explain_removed(recognition, is_refused_value=BAD_ENUM.search(query) is not None)
        recognition.missing = [
            missing
            for missing in recognition.missing
            if not own.have(missing) and not (self._enum_values.has_any(missing.name) and not missing.owner)
        ]
        self._missing.explain(recognition)
        recognition.matches.sort(key=lambda match: (-match.sure, match.why != "successor"))
        return recognition

    def _read(self, query: str, chains: list[Chain], own: OwnNames, recognition: Recognition) -> None:
        """Adds what a query names that is more than one spelling: in messages, expressions, values and plain words."""
        self._messages.recognise(query, recognition)
        lacked = [*recognition.missing]
        code = without_callers_names(without_wording(without_values(query)))
        is_plain = code == query and "/" not in query
        found = chains if is_plain else own.without(with_bindings(code, _outside_of_paths(code)))
        self._expressions.recognise(found, recognition)
        if any(True for _ in members_named(query)):
            recognition.alike, recognition.alike_lost = [], None
        if any(match.why == "error message" and match.sure >= _TOLD for match in recognition.matches):
            # Of which collection it is, the message has told.
            recognition.missing = [one for one in recognition.missing if one.owner != COLLECTION]
        if items_listed(query):  # by which the enumeration is found
            symbols = {match.id: self._reader.symbol(match.id) for match in recognition.matches}
            others = {path for path, symbol in symbols.items() if symbol and is_other_enum(symbol, query)}
            recognition.matches = [match for match in recognition.matches if match.id not in others]
            recognition.alike = []
        if lacked or (is_message(query) and says_what_failed(query)):
            # What else the line lacks that failed, Python has found there, or has not come to.
            recognition.missing, recognition.doubted = lacked, None
        text = without_callers_names(without_wording(query))
        self._enum_values.recognise(text, recognition, classes_of_things(query))
        self._removed_values(text, recognition)
        if not is_message(query):
            self._described(query, recognition)

    def _described(self, query: str, recognition: Recognition) -> None:
        """Adds what plain words describe: the inputs of a modifier, a menu that is to be extended."""
        described = asked_of_inputs(query)
        if described and self._reader.entry(described):
            recognition.add(described, _DESCRIBED, "described")
        if extended := menu_extended(query, self._reader):
            recognition.add(extended.path, _DESCRIBED, "described")
            recognition.notes.append(extended.note)

    def _is_of_blender(self, name: str) -> bool:
        """Whether a module or class is Blender's, or was of other versions or builds."""
        paths = (name, *(package + name for package in _PACKAGES))
        known = (self._reader.entry(path) for path in paths)
        is_here = any(entry is not None and entry.kind in {"module", "class"} for entry in known)
        return (
            is_here
            or name in self._reader.history.unknown_modules
            or any(map(self._reader.history.removed, (name, TYPES + name)))
        )

    def _removed_values(self, text: str, recognition: Recognition) -> None:
        """Adds enum items that a property in the query has only in other versions."""
        for value in self._enum_values.values(text):
            if _is_told(value, recognition):
                continue
            for match in [match for match in recognition.matches if match.sure >= _SURE]:
                symbol = self._reader.symbol(match.id)
                if symbol and (removed := self._lost_values.value(symbol, value)):
                    recognition.add_removed(removed)

    def _values_of_nothing(self, query: str, recognition: Recognition) -> None:
        """Adds enum items that nothing has now, where no use in the query has told of what they were removed."""
        for value in self._enum_values.values(without_callers_names(without_wording(query))):
            if _is_told(value, recognition) or "_" not in value or self._reader.names.enum_owners(key(value)):
                continue
            for removed in self._removed.spelled(value):
                if removed.path.endswith(f":{value}"):
                    recognition.add_removed(removed)

    def _explain_removed(self, recognition: Recognition, *, is_refused_value: bool) -> None:
        """Adds what took the place of the removed symbols; the owner where nothing did."""
        if is_refused_value:  # then what it was set to is there
            recognition.removed = [one for one in recognition.removed if {":", "("} & {*one.path}]
        # Whatever else fits some word of the query would pass for the successor.
        guesses = _GUESSES if recognition.dead_end else _OF_STRINGS if recognition.removed else ()
        recognition.matches = [match for match in recognition.matches if match.why not in guesses]
        for place, removed in enumerate(recognition.removed[:_FEW]):
            later = 0.03 * place
            for rank, target in enumerate(removed.targets[:_FEW]):
                recognition.add(plain_path(target), 1.0 - 0.01 * rank - later, "successor")
                _, is_argument, item = target.partition("):")
                for cls, maker in self._reader.makers.made_by_choice(item) if is_argument else ():
                    if maker == plain_path(target):
                        recognition.add(cls, 0.985 - 0.01 * rank - later, "made with the successor")
            if not removed.targets:
                for owner in self._owners(removed):
                    recognition.add(owner, _OWNER_OF_REMOVED - later, "owner")
            for rank, (target, score) in enumerate(removed.similar):
                sure = _LIKELY_GUESS if score >= _LIKELY else _GUESS
                recognition.add(plain_path(target), sure - 0.005 * rank - later, "replacement")

    def _owners(self, removed: RemovedSymbol) -> list[str]:
        """The class, node, property or operator that a removed symbol belonged to, if this version has it."""
        whole = plain_path(removed.path)
        owner = (
            whole if whole != removed.path else socket_node(removed.path) or removed.path.rpartition(".")[0]
        )
        entry = self._reader.entry(owner)
        return [owner] if entry and entry.kind != "module" else []
