"""What code does with names that are known: the values that it sets, the arguments that it gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.paths import plain_path
from kb_serve.recognise.chains.refusals import keywords
from kb_serve.recognise.chains.variables import is_guess, usual_classes
from kb_serve.recognise.code.contexts import NO_OVERRIDE, OVERRIDE
from kb_serve.recognise.code.met_conditions import is_met
from kb_serve.recognise.code.products import WITH_AT, Products
from kb_serve.recognise.code.python_methods import is_method_of_python
from kb_serve.recognise.code.wrong_arguments import wrong_arguments
from kb_serve.recognise.code.wrong_values import wrong_values
from kb_serve.recognise.message_patterns import items_listed

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.named.enum_values import EnumValues
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.lost_values import LostValues
    from kb_serve.recognise.removed.old_texts import OldTexts
    from kb_serve.recognise.resolver import Resolver

_FEW = 3
_SURE = 0.9
_OF_AN_OPERATOR = 0.98  # how sure an operator is of which one has a value by the name of its argument
_SOCKET_VALUE = "The value of a socket is its `default_value`: `node.inputs[…].default_value = …`."
_OF_OPERATOR = "`{0}` may be the properties of an operator: `{0} = layout.operator(…)`."


class Uses:
    """Checks how code uses the names of one base."""

    def __init__(
        self,
        reader: BaseReader,
        resolver: Resolver,
        enum_values: EnumValues,
        old_texts: OldTexts,
        lost_values: LostValues,
    ) -> None:
        self._reader = reader
        self._enum_values = enum_values
        self._old_texts = old_texts
        self._lost_values = lost_values
        self._products = Products(resolver)

    def check(self, query: str, chains: list[Chain], recognition: Recognition) -> None:
        """Adds removed values and arguments of what was recognised, and notes on wrong ones."""
        for product, factor in self._products.wrong(query, chains):
            recognition.notes += (f"Write `{product}`.", WITH_AT)
            recognition.add(factor, _SURE, "wrong operator")
        old = self._old_texts
        for removed in (*old.in_imports(query), *old.in_strings(query), *old.in_keyword(query)):
            recognition.add_removed(removed)
        for taken_as in old.still_taken_in_strings(query):
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
            if is_method_of_python(_name(chain), symbol) or is_other_enum(symbol, query):
                continue  # what it takes and gives is no value of the symbol
            for value in chain.values:
                where = self._enum_values.where(symbol.path, value)
                if where and not is_met(symbol.path, where, query, chains, self._reader):
                    recognition.notes.append(self._enum_values.condition(symbol.path, value))
            lost = list(self._lost_values.in_values(chain, symbol))
            for removed in lost:
                recognition.add_removed(removed)
            gone = {removed.path for removed in (*lost, *recognition.removed)}
            notes = list(wrong_arguments(chain, symbol, self._reader, gone))
            renamed = dict(
                filter(None, (one.renamed_argument(symbol.path) for one in (*lost, *recognition.removed)))
            )
            recognition.notes += (*notes, *wrong_values(chain, symbol, gone, self._reader, renamed))
            if any(note.startswith(NO_OVERRIDE) for note in notes):
                recognition.add(OVERRIDE, 0.98, "error message")  # before the operator that does not take it

    def _check_guesses(self, chain: Chain, query: str, recognition: Recognition) -> None:
        """Adds what was lost by what a chain may be read as, and a note on a value that nothing so called takes."""
        guesses = list(filter(None, map(self._reader.symbol, recognition.guesses.get(chain.key, ()))))
        if any(is_method_of_python(_name(chain), guess) for guess in guesses):
            return
        lost = [next(self._lost_values.in_values(chain, guess), None) for guess in guesses]
        if len(guesses) == 1 and keywords(chain):  # which may have told it from others of its name
            recognition.notes += wrong_arguments(chain, guesses[0], self._reader)
        # A value that what it may be read as once took tells that it is meant.
        for removed in filter(None, lost):
            recognition.add_removed(removed)
        is_unknown = is_guess(chain.root) and len(guesses) > 1
        if guesses and guesses[0].kind in {"property", "socket"} and not any(lost):
            name = guesses[0].path[len(guesses[0].owner) :]
            owners = [
                path for value in chain.values for path, *_ in self._reader.names.enum_owners(key(value))
            ]
            if any(path.endswith(name) for path in owners):
                return
            if is_other_enum(guesses[0], query):
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
        for place, operator in enumerate(self._reader.usage.heaviest(entries)[:_FEW]):
            recognition.add(operator.path, _OF_AN_OPERATOR - 0.01 * place, "enum item")
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


def is_other_enum(symbol: Symbol, query: str) -> bool:
    """Whether a property lacks items that a message lists as those of the one that was set."""
    listed = items_listed(query) if symbol.kind == "property" and symbol.enum_items else frozenset[str]()
    return bool(listed) and not listed <= {item.identifier for item in symbol.enum_items}


def _sets_a_socket(chain: Chain) -> bool:
    """Whether a chain assigns to a socket itself, which Blender refuses."""
    last = chain.steps[-2:]
    return chain.assigned and len(last) == 2 and last[0].text == "inputs" and last[1].kind in {"key", "index"}


def _name(chain: Chain) -> str:
    return chain.attributes[-1] if chain.attributes else chain.root
