"""Recognises names that stand without their owners (``thickness_outer``), by the words around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.schema import FORM_NAME, FORM_SHORT
from kb_build.symbols.api_names import TYPES
from kb_serve.recognise.named.enum_values import is_value
from kb_serve.recognise.named.node_names import add_nodes_meant, is_like_a_node
from kb_serve.recognise.recognition import SIMILAR, MissingName

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.likely.corrections import Corrector
    from kb_serve.recognise.recognition import Recognition

_FEW = 3
_LONG = 12  # letters from which on a name is corrected without knowing what it belongs to
_NODE_MEANT = 0.93  # how sure a node is that a name which none has may mean
_UNREACHED = 99  # steps
_CALLED_OR_SET = frozenset({"property", "function", "operator"})


class LooseNames:
    """Recognises such names against one base."""

    def __init__(self, reader: BaseReader, corrector: Corrector) -> None:
        self._reader = reader
        self._corrector = corrector

    def recognise(
        self, chain: Chain, prose: set[str], recognition: Recognition, *, is_variable: bool
    ) -> None:
        """Adds the owners of a name that stands without one, by the words around it. What may well be a
        variable, beside other code, is not corrected, nor denied.
        """
        name = chain.attributes[-1] if chain.attributes else chain.root
        called = [
            identifier
            for form, identifier in self._reader.names.by_key(key(name))
            if form in {FORM_NAME, FORM_SHORT}
        ]
        self._reader.entry.load(called)
        rows = list(filter(None, map(self._reader.entry, called)))
        if not (rows or chain.steps or is_variable) and is_like_a_node(name):
            add_nodes_meant(name, _NODE_MEANT, self._reader, recognition)
            return
        same = [entry for entry in rows if entry.name == name]  # before the same letters
        rows = same or ([] if name.isupper() and is_value(name, self._reader) else rows)
        lone = not chain.attributes or len(name) >= _LONG
        lone = lone and not name.isupper() and not is_variable
        if not rows and lone and (correction := self._corrector.member(name)):
            recognition.corrections.append(correction)
            rows = [entry for entry in self._reader.names.by_name(correction.meant) if entry.group != "ui"]
        if not (rows or prose or chain.steps or is_variable):
            self._parts(chain, recognition)
        if chain.attributes and len(rows) > _FEW:
            return  # a common name that its owner in the query does not have
        if len(rows) > 1:
            rows = self._likeliest_owners(rows, prose)
        for rank, entry in enumerate(rows[:5]):
            sure = 0.9 if len(rows) == 1 else 0.84
            if chain.attributes and (len(rows) > 1 or "_" not in name):
                sure = 0.55
            elif entry.kind == "class" and chain.steps:
                sure = 0.8  # ``BMElemSeq[index]`` in a message: what it says about the class comes first
            recognition.add(entry.path, sure - 0.03 * rank, "name")

    def _parts(self, chain: Chain, recognition: Recognition) -> None:
        """Adds the names that one which never was is made of, each as the likeliest class has it."""
        name = chain.root
        entries = [
            entry for part in self._corrector.parts(name) for entry in self._reader.names.by_name(part)
        ]
        entries = [entry for entry in entries if entry.group != "ui" and entry.kind in _CALLED_OR_SET]
        weights = self._reader.usage.weights([entry.path for entry in entries])
        best: dict[str, str] = {}
        about = set(terms(name))
        # ``select_all_objects`` is hardly the one of bones.
        entries.sort(key=lambda entry: (-len(about & set(terms(entry.owner))), -weights.get(entry.path, 0.0)))
        for entry in entries:
            best.setdefault(entry.name, entry.path)
        for rank, path in enumerate(list(best.values())[:_FEW]):
            recognition.add(path, 0.84 - 0.01 * rank, SIMILAR)
        is_name = "_" in name and not chain.assigned and not self._reader.names.by_key(key(name))
        if best or (is_name and not self._reader.names.is_written(name)):
            recognition.missing.append(MissingName(name))

    def _likeliest_owners(self, rows: list[SymbolEntry], prose: set[str]) -> list[SymbolEntry]:
        """Symbols of one name, those first whose owners the words around it name, which are usual, which count most,
        and to which the shortest path leads: strips of a scene before those within another strip.
        """
        weights = self._reader.usage.weights([entry.path for entry in rows])
        owners = {entry.path: self._reader.entry(entry.owner) for entry in rows}

        def place(entry: SymbolEntry) -> tuple[int, bool, float, int]:
            owner = owners[entry.path]
            about = f"{entry.owner.removeprefix(TYPES)} {owner.label if owner else ''} {entry.label}"
            said = len(set(terms(about)) & prose)
            is_usual = entry.group != "ui" and entry.kind in _CALLED_OR_SET
            return -said, not is_usual, -weights.get(entry.path, 0.0), len(set(terms(about)))

        rows = sorted(rows, key=place)
        same = [entry for entry in rows if place(entry)[:3] == place(rows[0])[:3]]
        if len(same) > 1:
            rows[: len(same)] = sorted(same, key=self._far)
        return rows

    def _far(self, entry: SymbolEntry) -> int:
        """How many steps lead to what has a member; many where that is not known."""
        symbol = self._reader.symbol(entry.owner)
        return symbol.reached.count(".") if symbol and symbol.reached else _UNREACHED
