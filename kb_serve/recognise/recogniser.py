"""Recognises the symbols and pages that a query names, in any form: a spelling, call, expression, error message,
enum value or URL. Descriptions are left to the search.
"""

from __future__ import annotations

import re
from bisect import bisect
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, tokens
from kb_build.symbols.api_names import COLLECTION, ID, OPERATORS, TYPES
from kb_build.symbols.paths import last_name, plain_path, socket_node
from kb_serve.recognise.code.contexts import NO_OVERRIDE, OVERRIDE
from kb_serve.recognise.code.expressions import Expressions
from kb_serve.recognise.code.met_conditions import is_met
from kb_serve.recognise.code.operator_properties import explain_properties
from kb_serve.recognise.code.own_names import own_names
from kb_serve.recognise.code.products import WITH_AT, Products
from kb_serve.recognise.code.python_methods import is_method_of_python
from kb_serve.recognise.code.refusals import keywords
from kb_serve.recognise.code.wrong_arguments import wrong_arguments
from kb_serve.recognise.code.wrong_values import wrong_values
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
from kb_serve.recognise.names.by_words.menus_by_words import menu_extended
from kb_serve.recognise.names.by_words.operator_words import OperatorWords
from kb_serve.recognise.names.by_words.said_otherwise import said_otherwise
from kb_serve.recognise.names.elsewhere.holders import by_what_holds_it
from kb_serve.recognise.names.elsewhere.inputs_meant import input_meant
from kb_serve.recognise.names.elsewhere.meant_elsewhere import meant_elsewhere
from kb_serve.recognise.names.elsewhere.members_within import members_within
from kb_serve.recognise.names.elsewhere.other_kinds import of_another_kind
from kb_serve.recognise.names.likely.corrections import (
    Corrector,
    by_first_word,
    names_meant,
    nearest,
    shortened,
)
from kb_serve.recognise.names.named.addresses import ids_in_urls
from kb_serve.recognise.names.named.enum_values import EnumValues
from kb_serve.recognise.names.named.spellings import Spellings
from kb_serve.recognise.notes import SIMILAR
from kb_serve.recognise.recognition import MissingName, Recognition
from kb_serve.recognise.removed.newer_nodes import (
    name_on_an_old_node,
    tell_of_the_newer_mix,
    tell_of_the_newer_node,
)
from kb_serve.recognise.removed.old_code import OldCode
from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup
from kb_serve.recognise.resolving.bindings import with_bindings
from kb_serve.recognise.resolving.chains import Chain, find_chains
from kb_serve.recognise.resolving.resolver import Resolver
from kb_serve.recognise.resolving.subscripts import asked_of_inputs
from kb_serve.recognise.resolving.variables import is_guess, usual_classes

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

# What the panels of render engines name engines by, whether this Blender has them or not: none is set.
_FOR_ENGINES = re.compile(r"\bCOMPAT_ENGINES\s*=\s*[{(\[][^})\]]*")
_FEW_OWN = 2  # properties of a class that is asked for one which it lacks
# In which classes are that scripts import by name.
_PACKAGES = (TYPES, "mathutils.", "bmesh.types.")
_FILE_PATH = re.compile(r"""(?<!\[)(['"])[^'"\n/]*/[^'"\n]*\1""")
_FEW = 3
_SURE = 0.9
_WITHIN = 0.98  # how sure the very name is on a part of what lacks it
_SPELLED_ALIKE = 0.9  # similarity from which on another name may be a slip of the fingers
_MANY = 12
_DESCRIBED = 0.85  # … what plain words describe
_HELD_PERHAPS = 0.93  # … and what holds such things and does it, where little tells what lacks the name
_OTHERWISE = 0.96  # what does or is labelled what a class is asked for by another name
_LABEL_ENDS = 0.87  # … what has a label that ends with that name
_SHORTENED = 0.92  # … what a word is short for
_BEGINS_ALIKE = 0.86  # … what begins like a name that its class lacks
_OWNER_ALONE = 0.81  # how sure a class is whose member exists nowhere
_OWNER_OF_REMOVED = 0.85  # … one whose removed member has no known successor
# Of names that resemble a removed one: how sure those are from a score on; half of these are its successors, of the
# others a quarter, and as many have none (found by comparing the guesses with the table of successors).
_LIKELY = 1.1
_LIKELY_GUESS = 0.88
_GUESS = 0.83
_SOCKET_VALUE = "The value of a socket is its `default_value`: `node.inputs[…].default_value = …`."
_OF_OPERATOR = "`{0}` may be the properties of an operator: `{0} = layout.operator(…)`."
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


def _sets_a_socket(chain: Chain) -> bool:
    """Whether a chain assigns to a socket itself, which Blender refuses."""
    last = chain.steps[-2:]
    return chain.assigned and len(last) == 2 and last[0].text == "inputs" and last[1].kind in {"key", "index"}


def _name(chain: Chain) -> str:
    return chain.attributes[-1] if chain.attributes else chain.root


def _is_told(value: str, recognition: Recognition) -> bool:
    """Whether it is already known of an enum item that it was removed."""
    return any(removed.path.endswith(f":{value}") for removed in recognition.removed)


class Recogniser:
    """Recognises names against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._resolver = Resolver(reader)
        self._corrector = Corrector(reader, self._resolver)
        self._removed = RemovedSymbolLookup(reader)
        self._spellings = Spellings(reader, self._removed)
        self._enum_values = EnumValues(reader)
        self._messages = Messages(reader, self._removed, self._enum_values)
        self._old = OldCode(reader, self._resolver, self._removed)
        self._operators = OperatorWords(reader)
        self._expressions = Expressions(reader, self._resolver, self._corrector, self._old, self._operators)
        self._products = Products(self._resolver)

    def recognise(self, query: str) -> Recognition:
        """Everything that ``query`` names, surest first."""
        query = _FOR_ENGINES.sub("COMPAT_ENGINES", query)
        recognition = Recognition()
        own = own_names(query, self._is_of_blender)
        chains = own.without(with_bindings(query, find_chains(query)))
        recognition.notes += (
            _UNKNOWN_MODULE.format(version=self._reader.meta.get("minor", ""), module=module)
            for module in sorted(self._reader.unknown_modules.intersection(tokens(query)))
        )
        for identifier in ids_in_urls(query, self._reader):
            recognition.add(identifier, 1.0, "address")
        self._spellings.recognise(query, recognition)
        is_settled = recognition.best is not None and recognition.best.sure >= 1
        if not is_settled:
            self._messages.recognise(query, recognition)
            lacked = [*recognition.missing]
            text = without_callers_names(without_wording(query))
            code = without_callers_names(without_wording(without_values(query)))
            is_plain = code == query and "/" not in query
            found = chains if is_plain else own.without(with_bindings(code, _outside_of_paths(code)))
            self._expressions.recognise(found, recognition)
            if any(True for _ in members_named(query)):
                recognition.alike, recognition.alike_lost = [], None
            if any(match.why == "error message" and match.sure >= _WITHIN for match in recognition.matches):
                # Of which collection it is, the message has told.
                recognition.missing = [one for one in recognition.missing if one.owner != COLLECTION]
            if items_listed(query):  # by which the enumeration is found
                symbols = {match.id: self._reader.symbol(match.id) for match in recognition.matches}
                others = {
                    path for path, symbol in symbols.items() if symbol and self._is_other_enum(symbol, query)
                }
                recognition.matches = [match for match in recognition.matches if match.id not in others]
                recognition.alike = []
            if lacked or (is_message(query) and says_what_failed(query)):
                # What else the line lacks that failed, Python has found there, or has not come to.
                recognition.missing, recognition.doubted = lacked, None
            self._enum_values.recognise(text, recognition, classes_of_things(query))
            self._removed_values(text, recognition)
            described = "" if is_message(query) else asked_of_inputs(query)
            if described and self._reader.entry(described):
                recognition.add(described, _DESCRIBED, "described")
            if extended := None if is_message(query) else menu_extended(query, self._reader):
                recognition.add(extended.path, _DESCRIBED, "described")
                recognition.notes.append(extended.note)
        self._check_uses(query, chains, recognition)
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
        self._explain_missing(recognition)
        recognition.matches.sort(key=lambda match: (-match.sure, match.why != "successor"))
        return recognition

    def _is_of_blender(self, name: str) -> bool:
        """Whether a module or class is Blender's, or was of other versions or builds."""
        paths = (name, *(package + name for package in _PACKAGES))
        known = (self._reader.entry(path) for path in paths)
        is_here = any(entry is not None and entry.kind in {"module", "class"} for entry in known)
        return (
            is_here
            or name in self._reader.unknown_modules
            or any(map(self._reader.removed, (name, TYPES + name)))
        )

    def _check_uses(self, query: str, chains: list[Chain], recognition: Recognition) -> None:
        """Adds removed values and arguments of what was recognised, and notes on wrong ones."""
        for product, factor in self._products.wrong(query, chains):
            recognition.notes += (f"Write `{product}`.", WITH_AT)
            recognition.add(factor, _SURE, "wrong operator")
        in_strings = (*self._old.in_strings(query), *self._old.in_keyword(query))
        for removed in (*self._old.in_imports(query), *in_strings):
            recognition.add_removed(removed)
        for taken_as in self._old.still_taken_in_strings(query):
            recognition.add_former_name(taken_as, _SURE)
        for chain in chains:
            if _sets_a_socket(chain):
                recognition.notes.append(_SOCKET_VALUE)
            called = chain.call is not None
            if not (called or chain.values):
                continue
            symbol = self._reader.symbol(
                self._read_as(chain, recognition) or self._successor(chain, recognition)
            )
            if symbol is None:
                self._check_guesses(chain, query, recognition)
                continue
            if is_method_of_python(_name(chain), symbol) or self._is_other_enum(symbol, query):
                continue  # what it takes and gives is no value of the symbol
            for value in chain.values:
                where = self._enum_values.where(symbol.path, value)
                if where and not is_met(symbol.path, where, query, chains, self._reader):
                    recognition.notes.append(self._enum_values.condition(symbol.path, value))
            old = list(self._old.in_values(chain, symbol))
            for removed in old:
                recognition.add_removed(removed)
            gone = {removed.path for removed in (*old, *recognition.removed)}
            notes = list(wrong_arguments(chain, symbol, self._reader, gone))
            renamed = dict(
                filter(None, (one.renamed_argument(symbol.path) for one in (*old, *recognition.removed)))
            )
            recognition.notes += (*notes, *wrong_values(chain, symbol, gone, self._reader, renamed))
            if any(note.startswith(NO_OVERRIDE) for note in notes):
                recognition.add(OVERRIDE, 0.98, "error message")  # before the operator that does not take it

    @staticmethod
    def _is_other_enum(symbol: Symbol, query: str) -> bool:
        """Whether a property lacks items that a message lists as those of the one that was set."""
        listed = items_listed(query) if symbol.kind == "property" and symbol.enum_items else frozenset()
        return bool(listed) and not listed <= {item.identifier for item in symbol.enum_items}

    def _check_guesses(self, chain: Chain, query: str, recognition: Recognition) -> None:
        """Adds what was lost by what a chain may be read as, and a note on a value that nothing so called takes."""
        guesses = list(filter(None, map(self._reader.symbol, recognition.guesses.get(chain.key, ()))))
        if any(is_method_of_python(_name(chain), guess) for guess in guesses):
            return
        lost = [next(self._old.in_values(chain, guess), None) for guess in guesses]
        if len(guesses) == 1 and keywords(chain):  # which may have told it from others of its name
            recognition.notes += wrong_arguments(chain, guesses[0], self._reader)
        # A value that what it may be read as once took tells that it is meant.
        for removed in filter(None, lost):
            recognition.add_removed(removed)
        is_unknown = is_guess(chain.root) and len(guesses) > 1
        if guesses and guesses[0].kind in {"property", "socket"} and not any(lost):
            name = guesses[0].path[len(guesses[0].owner) :]
            owners = [path for value in chain.values for path, *_ in self._reader.enum_owners(key(value))]
            if any(path.endswith(name) for path in owners):
                return
            if self._is_other_enum(guesses[0], query):
                return
            if not self._are_of_operator(chain, owners, recognition) and not is_unknown:
                recognition.notes += wrong_values(chain, guesses[0], (), self._reader)

    def _are_of_operator(self, chain: Chain, owners: list[str], recognition: Recognition) -> bool:
        """Adds the operators of which one's properties may be what a variable holds, ``props.direction = 'DOWN'``: one
        has such a value by that name; whether there are any.
        """
        argument = f"({_name(chain)})"
        taking = [path.removesuffix(argument) for path in owners if path.endswith(argument)]
        if usual_classes(chain.root) or not taking:
            return False
        entries = filter(None, map(self._reader.entry, dict.fromkeys(taking)))
        for place, operator in enumerate(self._reader.heaviest(entries)[:_FEW]):
            recognition.add(operator.path, _WITHIN - 0.01 * place, "enum item")
        recognition.notes.append(_OF_OPERATOR.format(chain.root))
        return True

    @staticmethod
    def _read_as(chain: Chain, recognition: Recognition) -> str:
        """What a chain was read as, or else a match of its last name that no other was read as; empty for none, and
        where what it leads to surely lacks that name.
        """
        if (path := recognition.readings.get(chain.key)) is not None:
            return path
        if any(one.name == _name(chain) and one.sure for one in recognition.missing):
            return ""
        end = f".{_name(chain)}"
        others = set(recognition.readings.values())
        found = (match.id for match in recognition.matches if match.sure >= _SURE and match.id not in others)
        whole = f".{chain.dotted}"

        def is_written(path: str) -> bool:
            # An operator is written behind its module, or alone: ``con.add_target()`` is not ``constraint.add_target``.
            return f".{path}".endswith(whole if path.startswith(OPERATORS) else end)

        return next(filter(is_written, found), "")

    @staticmethod
    def _successor(chain: Chain, recognition: Recognition) -> str:
        """What took the place of a removed operator or function that is called; empty for none."""
        gone = (removed for removed in recognition.removed if removed.path == chain.dotted)
        return next((plain_path(removed.targets[0]) for removed in gone if removed.targets), "")

    def _removed_values(self, text: str, recognition: Recognition) -> None:
        """Adds enum items that a property in the query has only in other versions."""
        for value in self._enum_values.values(text):
            if _is_told(value, recognition):
                continue
            for match in [match for match in recognition.matches if match.sure >= _SURE]:
                symbol = self._reader.symbol(match.id)
                if symbol and (removed := self._old.value(symbol, value)):
                    recognition.add_removed(removed)

    def _values_of_nothing(self, query: str, recognition: Recognition) -> None:
        """Adds enum items that nothing has now, where no use in the query has told of what they were removed."""
        for value in self._enum_values.values(without_callers_names(without_wording(query))):
            if _is_told(value, recognition) or "_" not in value or self._reader.enum_owners(key(value)):
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
                for cls, maker in self._reader.made_by_choice(item) if is_argument else ():
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

    def _explain_missing(self, recognition: Recognition) -> None:
        """Adds what is meant by the names that classes lack, but for those that were removed."""
        removed = {symbol.path.rpartition(".")[2] for symbol in recognition.removed}
        for missing in recognition.missing:
            if missing.name not in removed:
                self._explain_name(missing, recognition)
        if (doubted := recognition.doubted) and not recognition.removed:
            self._meant(doubted, recognition)

    def _explain_name(self, missing: MissingName, recognition: Recognition) -> None:
        """Adds similar members of the class that lacks a name, or the name on other classes, or the class."""
        if self._meant(missing, recognition):
            return
        for place, path in enumerate(self._operators.having(missing.owner, missing.name)):
            recognition.add(path, 0.95 - 0.01 * place, SIMILAR)
        otherwise = said_otherwise(missing, self._operators, self._reader)
        names = names_meant(missing.owner, self._reader, called=missing.called)
        similar = nearest(missing.name, names)
        is_spelled_alike = bool(similar) and similar[0][1] >= _SPELLED_ALIKE
        if not is_spelled_alike and self._held(missing, otherwise, recognition):
            return
        is_meant = (
            is_spelled_alike
            or f"active_{missing.name}" in names
            or any(self._is_called(path, missing.name) for path in otherwise)
        )
        if not is_meant and self._within(missing, recognition, on_new=bool(otherwise)):
            return
        is_like = bool(otherwise) or any(name.startswith(missing.name) for name in names)
        if not (is_meant or is_like) and self._of_another_kind(missing, recognition):
            return
        for place, path in enumerate(otherwise):
            sure = _OTHERWISE if self._is_called(path, missing.name) else _LABEL_ENDS
            recognition.add(path, sure - 0.01 * place, SIMILAR)
        if missing.assigned:  # an assignment means ``select_set``, not ``select_get``
            similar.sort(
                key=lambda row: (-row[1], not row[0].startswith("set_") and not row[0].endswith("_set"))
            )
        for place, (name, alike) in enumerate(similar):
            if member := self._reader.member_of(missing.owner, name):
                recognition.add(member.path, 0.95 * alike - 0.01 * place, SIMILAR)
        if self._reader.entry(missing.owner) and not similar and not otherwise:
            self._like_nothing(missing, names, recognition)

    def _meant(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds what something near the class has that lacks a name, or the input of that name; whether there is any."""
        meant = meant_elsewhere(missing.owner, missing.name, self._reader)
        if meant is None:
            return self._as_input(missing, recognition)
        recognition.add(meant.path, _WITHIN if missing.told else _HELD_PERHAPS, "within")
        recognition.notes.append(meant.how)
        return True

    def _as_input(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the input of a node that is called as what it, or what is made of it, lacks; whether there is one."""
        socket = input_meant(missing.owner, missing.name, self._reader)
        if socket is None:
            return False
        recognition.add(socket.path, _WITHIN if missing.told else _HELD_PERHAPS, SIMILAR)
        recognition.notes += [socket.note] if socket.note else []
        return True

    def _like_nothing(self, missing: MissingName, names: list[str], recognition: Recognition) -> None:
        """Adds the members that begin with a name's first word or shorten it, and the name on other classes or the
        class.
        """
        begun = by_first_word(missing.name, names) if missing.told else []
        sure = _BEGINS_ALIKE
        if not begun and missing.told:
            sure, begun = _SHORTENED, shortened(missing.name, names)
        if not begun and missing.told:  # what has little else is asked for that
            own = self._reader.members(missing.owner)
            properties = [name for name, entry in own.items() if entry.kind == "property"]
            sure, begun = _BEGINS_ALIKE, properties if len(properties) <= _FEW_OWN else []
        for place, name in enumerate(begun):
            if member := self._reader.member_of(missing.owner, name):
                recognition.add(member.path, sure - 0.01 * place, SIMILAR)
        if not self._elsewhere(missing, recognition):
            recognition.add(missing.owner, _OWNER_ALONE, "owner")

    def _is_called(self, path: str, name: str) -> bool:
        """Whether something does what a name says, or is labelled so, rather than ends with it."""
        entry = self._reader.entry(path)
        return entry is not None and (entry.kind != "property" or key(entry.label) == key(name))

    def _held(self, missing: MissingName, otherwise: list[str], recognition: Recognition) -> bool:
        """Adds what holds such things and does what the name says, before the operator of that name; whether there is
        any.
        """
        found = by_what_holds_it(missing.owner, missing.name, self._reader)
        for rank, (path, how) in enumerate(found):
            recognition.add(path, (_WITHIN if missing.told else _HELD_PERHAPS) - 0.01 * rank, "within")
            if missing.told:
                recognition.notes.append(how)
        for path in otherwise if found else ():
            if last_name(path) == missing.name:
                recognition.add(path, _OTHERWISE - 0.01 * len(found), SIMILAR)
        return bool(found)

    def _of_another_kind(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the name on another kind of a thing, ``SunLight.angle`` for a PointLight; whether there is any."""
        other = of_another_kind(missing.owner, missing.name, self._reader) if missing.sure else None
        if other is None:
            return False
        recognition.add(other.member.path, _WITHIN, "within")
        recognition.notes.append(other.note)
        return True

    def _within(self, missing: MissingName, recognition: Recognition, *, on_new: bool) -> bool:
        """Adds the name on what the class points to, ``overlay`` of a SpaceView3D; whether there is any. What all
        data-blocks have is not looked for: any that something points to has it. ``on_new`` leaves out what is None on
        new things.
        """
        owner = self._reader.entry(missing.owner)
        is_class = owner is not None and owner.kind == "class"  # a module has nothing but its members
        if not (missing.told and is_class) or self._reader.entry(f"{ID}.{missing.name}"):
            return False
        found = members_within(missing.owner, missing.name, self._reader, on_new=on_new)
        sure = _WITHIN if missing.sure and not missing.variable else _SURE
        for rank, (member, note) in enumerate(found):
            recognition.add(member.path, sure - 0.01 * rank, "within")
            recognition.notes.append(note)
        return bool(found)

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
