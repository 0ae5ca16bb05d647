"""Recognises a query that is one name as a whole: a path, label, slug or title, in any case and punctuation."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.schema import FORM_LABEL, FORM_NAME, FORM_PATH, FORM_SHORT
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.rank.asked_words import SCRIPT_WORDS, wants_script
from kb_serve.recognise.chains.chain_starts import PROPERTIES
from kb_serve.recognise.message_patterns import is_message
from kb_serve.recognise.named.addresses import find_page
from kb_serve.recognise.named.enum_values import is_quoted_value, is_value
from kb_serve.recognise.named.lost_nodes import lost_nodes
from kb_serve.recognise.recognition import WHOLE_LABEL

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup

_MEMBER = re.compile(r"\s*(?:->|→|::)\s*")
# A name that is no word: with a ``_`` or a capital within.
_NAME = re.compile(r"(?=\w*[a-z\d](?:_\w|[A-Z]))[A-Za-z][\w.]+")
_CODE = frozenset("()[]=")
_MARKS = ",;:.?!`'\"()"
_FEW = 3
_NEAR = 2  # dots in the path of a module that a bare word may mean
_LONG_LABEL = 3  # words, which no question has by chance
_MOST_WORDS = 9  # of a question in which labels are looked for
_LABEL_WORDS = (3, 2)
_GEOMETRY_NODE = f"{TYPES}GeometryNode"
_OF_SCRIPTS = SCRIPT_WORDS | {"bmesh"}
_BY_CHANCE = 0.75  # of a label that a question says for something else; the search tells more
_LABEL_WITHIN = (
    0.79  # how sure what a part of a question is called is: it comes after the first that the words find
)
_OF_A_LABEL = 2
# Words of a question about what other versions had.
_OF_A_CHANGE = frozenset(
    {
        "deprecated",
        "disappeared",
        "gone",
        "instead",
        "removed",
        "renamed",
        "replaced",
        "replacement",
        "replaces",
    }
)
_KINDS = frozenset({"modifier", "constraint"})  # last words of labels, which may stand anywhere in a question
_USUAL, _BESIDE_USUAL = 0.98, 0.97  # … the class that plain words usually mean, and what is spelled so
_OTHERWISE = 0.85  # how sure a name is that shares only its key with the query


def _strangeness(text: str, identifier: str) -> int:
    """How unlike the query an identifier with the same key (see analysis.key) is, from 0."""
    if "_OT_" in text.upper():  # the operator says all that its class does
        return 0 if identifier.startswith(OPERATORS) else 1
    if identifier == f"bpy.ops.{text}":  # a module of operators is rarely what a bare word means
        return 2
    if f".{identifier}".endswith(f".{text}"):
        return 0
    if f".{identifier}".lower().endswith(f".{text.lower()}"):
        return 1
    return 2 if identifier.removeprefix(TYPES).count(".") == text.removeprefix(TYPES).count(".") else 3


def _class_of(text: str) -> str:
    """The path of the class whose member a text may be spelled as; empty for none."""
    cls = text.removeprefix(TYPES).rpartition(".")[0]
    return TYPES + cls if cls and "." not in cls else ""


def _called(text: str) -> str:
    """``f`` of ``f(a, b)``; the text itself if it is not a call, or continues after it."""
    start, depth = text.find("("), 0
    if start < 0 or not text.endswith(")"):
        return text
    for position, char in enumerate(text[start:], start):
        depth += (char == "(") - (char == ")")
        if depth == 0 and position + 1 < len(text):
            return text
    return text[:start]


class Spellings:
    """Recognises whole spellings against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the symbols and pages that the whole query names."""
        text = query.strip().strip("`'\"").rstrip(".:;,?!")
        if is_quoted_value(query, self._reader):
            return  # ``'EMITTER'`` is not the page of emitters
        if self._path(text, recognition):
            return
        in_words = " " in text and not is_message(query) and _CODE.isdisjoint(query)
        if in_words:
            self._lost_nodes(text.lower().split(), recognition)
        if slug := find_page(text, self._reader):
            recognition.add(slug, 1.0, "exact")
            return
        called = _MEMBER.sub(".", _called(text))
        # Rather than RNA's class of the same name.
        if " " not in called and self._reader.entry(PROPERTIES + called):
            recognition.add(PROPERTIES + called, 1.0, "exact")
            return
        if inherited := self._inherited(called):
            recognition.add(inherited, 1.0, "exact")
            return
        if " " in text:
            self._labelled(text, recognition)
            self._labels_within(text.split(), recognition)
            self._lost_within(text.lower().split(), recognition)
            if in_words:
                self._lost_names(text.split(), recognition)
        rows = self._reader.names.by_key(key(called))
        if rows:
            self._spelled(called, rows, recognition)
        in_plain_words = " " in called and called.islower()
        if not in_plain_words and (recognition.best is None or recognition.best.sure < 1):
            for removed in self._removed.spelled(called):
                recognition.add_removed(removed)

    def _path(self, text: str, recognition: Recognition) -> bool:
        """Adds the symbol that has a text as its path, or had it once; whether there is one."""
        candidates = (text, f"bpy.{text}")
        is_one_word = " " not in text
        if is_one_word:  # what else it may be is looked for behind this
            self._reader.entry.load((*candidates, PROPERTIES + text, TYPES + text, _class_of(text)))
        if "[" not in text and (not is_one_word or self._reader.entry(PROPERTIES + text)):
            return False  # only sockets' have spaces, in brackets
        self._reader.entry.load(candidates)
        if path := next(filter(self._reader.entry, candidates), ""):
            recognition.add(path, 1.0, "exact")
        elif taken_as := self._reader.history.still_works(TYPES + text):
            recognition.add_former_name(taken_as, 1.0)
            path = taken_as
        return bool(path)

    def _inherited(self, text: str) -> str:
        """The member that a class inherits which is spelled as its own: ``GreasePencilLayer.hide``; "" for others."""
        cls, name = _class_of(text), text.rpartition(".")[2]
        if not cls or not self._reader.entry(cls):
            return ""
        member = self._reader.member_of(cls, name)
        return member.path if member and member.owner != cls else ""

    def _spelled(self, text: str, rows: Sequence[tuple[int, str]], recognition: Recognition) -> None:
        """Adds the symbols and pages with the query's key; the fuller the spelling, the surer."""
        dotted = "." in text
        plain = " " not in text.strip()
        is_long = text.count(" ") + 1 >= _LONG_LABEL
        strange = {identifier: _strangeness(text, identifier) for _, identifier in rows}
        typed = 0 in strange.values() or self._is_enum_item(text) or self._is_removed(text)
        weights = self._reader.usage.weights(strange) if len(rows) > 1 or not plain else {}
        usual = "" if plain or dotted else self._usual_class(rows, weights)
        if usual:
            recognition.add(usual, _USUAL, "label")
        for form, identifier in sorted(rows, key=lambda row: (strange[row[1]], -weights.get(row[1], 0.0))):
            if form == FORM_PATH or (form == FORM_SHORT and "/" not in identifier):
                # ``view_layers`` and ``ViewLayers`` share a key: the one in another spelling is hardly meant.
                is_meant = not (typed and strange[identifier] > 1)
                recognition.add(
                    identifier, _BESIDE_USUAL if usual else 1.0 if is_meant else _OTHERWISE, "exact"
                )
            elif form in {FORM_NAME, FORM_LABEL} and not dotted:
                same = self._last_part(identifier) == text
                sure = 0.9 if same and plain and "_" in text else WHOLE_LABEL if is_long else 0.7
                if same and len(strange) == 1 and self._is_main_module(identifier):
                    sure = 1.0
                recognition.add(identifier, sure, "name")
            else:
                recognition.add(identifier, WHOLE_LABEL if is_long else 0.75, "title")

    def _usual_class(self, rows: Sequence[tuple[int, str]], weights: Mapping[str, float]) -> str:
        """The class whose whole label plain words are, if it counts more than what has them as its name; empty for
        none: ``noise texture`` is the node, before the brush's texture.
        """
        others = {identifier for form, identifier in rows if form != FORM_LABEL}
        labelled = [
            entry
            for form, identifier in rows
            if form == FORM_LABEL and identifier not in others and (entry := self._reader.entry(identifier))
        ]
        classes = [entry.path for entry in labelled if entry.kind == "class"]
        best = max(classes, key=lambda path: weights.get(path, 0.0), default="")
        most = max((weights.get(path, 0.0) for path in others), default=0.0)
        return best if best and weights.get(best, 0.0) > most else ""

    def _labelled(self, text: str, recognition: Recognition) -> None:
        """Adds classes and operators with exactly this label; for modifiers, Blender's default name will do."""
        labels = (f"{text} Modifier", f"{text} Constraint", text)
        self._reader.names.by_key.load(map(key, labels))
        entries = [
            entry
            for label in labels
            for form, identifier in self._reader.names.by_key(key(label))
            if form == FORM_LABEL and (entry := self._reader.entry(identifier)) and entry.label == label
        ]
        named = [entry for entry in entries if entry.kind in {"class", "operator"}]
        for rank, entry in enumerate(named[:_FEW]):
            recognition.add(entry.path, 0.9 if len(named) == 1 else 0.83 - 0.01 * rank, "label")

    def _labels_within(self, words: Sequence[str], recognition: Recognition) -> None:
        """Adds the classes whose labels, of several words, are part of a question: ``sky texture world``."""
        if not _LONG_LABEL <= len(words) <= _MOST_WORDS:
            return
        parts = [
            " ".join(words[start : start + length])
            for length in _LABEL_WORDS
            for start in range(len(words) - length + 1)
            if length < len(words)
        ]
        typed = frozenset(parts)
        for_a_script = wants_script(frozenset(map(str.lower, words)), _OF_SCRIPTS)
        # Looked up in memory: there are dozens in a question, and hardly ever a class is called so.
        # ``track to`` is a constraint, and so is ``copy location``; a modifier's name alone is mostly a plain word.
        parts += [f"{part} constraint" for part in parts]
        parts += [
            f"{word} {kind}" for kind in _KINDS.intersection(words) for word in words if word not in _KINDS
        ]
        for part in parts:
            if not (paths := self._reader.names.labelled_classes.get(part.lower())):
                continue
            self._reader.entry.load(paths)
            classes = list(filter(None, map(self._reader.entry, paths)))
            is_typed = part.count(" ") + 1 >= _LONG_LABEL and part in typed
            for rank, entry in enumerate(self._reader.usage.heaviest(classes)[:_OF_A_LABEL]):
                # Geometry nodes are called what scripts do otherwise: ``convert curve to mesh by python``.
                by_chance = for_a_script and self._reader.descends(entry.path, _GEOMETRY_NODE)
                sure = _BY_CHANCE if by_chance else WHOLE_LABEL if is_typed else _LABEL_WITHIN
                recognition.add(entry.path, sure - 0.01 * rank, "label")

    def _lost_within(self, words: Sequence[str], recognition: Recognition) -> None:
        """Adds what the words of a question about a change name that other versions alone have: ``what replaced face
        maps``.
        """
        if len(words) > _MOST_WORDS or _OF_A_CHANGE.isdisjoint(words):
            return
        for length in _LABEL_WORDS:
            parts = (words[start : start + length] for start in range(len(words) - length + 1))
            names = ["_".join(part) for part in parts if _OF_A_CHANGE.isdisjoint(part)]
            lost = [removed for name in names for removed in self._lost(name)]
            for removed in lost:
                recognition.add_removed(removed)
            if lost:
                return

    def _lost_names(self, words: Sequence[str], recognition: Recognition) -> None:
        """Adds what other versions alone have by the names among words, as code writes them: ``use_auto_smooth,
        calc_normals_split``.
        """
        names = [word.strip(_MARKS) for word in words] if len(words) <= _MOST_WORDS else []
        for name in dict.fromkeys(filter(_NAME.fullmatch, names)):
            lost = self._lost(name)
            for removed in lost if len(lost) <= _FEW else self._lost_members(name):
                recognition.add_removed(removed)

    def _lost_nodes(self, words: Sequence[str], recognition: Recognition) -> None:
        """Adds the nodes that are gone, by what people call them."""
        paths = lost_nodes(words, self._reader) if len(words) <= _MOST_WORDS else ()
        for removed in filter(None, map(self._removed.of_path, paths)):
            recognition.add_removed(removed)

    def _lost(self, name: str) -> list[RemovedSymbol]:
        """What other versions alone have by a name of several words, as a path or as a member of some class."""
        if self._reader.names.by_key(key(name)):
            return []
        return [*self._removed.spelled(name)] or self._lost_members(name)

    def _lost_members(self, name: str) -> list[RemovedSymbol]:
        """The member of that name, of which it is known what took its place, of the class that counts most."""
        paths = [path for path in self._removed.paths_named(name) if self._reader.history.successors(path)]
        weights = self._reader.usage.weights({path.rpartition(".")[0] for path in paths})
        paths.sort(key=lambda path: -weights.get(path.rpartition(".")[0], 0.0))
        return [*filter(None, map(self._removed.of_path, paths[:1]))]

    def _is_enum_item(self, text: str) -> bool:
        return "_" in text and is_value(text, self._reader)

    def _is_removed(self, text: str) -> bool:
        return any(self._reader.history.removed(path) for path in (text, TYPES + text))

    def _is_main_module(self, identifier: str) -> bool:
        """Whether an identifier is a module of ``bpy`` that scripts use: ``bpy.app.handlers``."""
        entry = self._reader.entry(identifier)
        is_near = identifier.startswith("bpy.") and identifier.count(".") <= _NEAR
        return is_near and entry is not None and entry.kind == "module"

    @staticmethod
    def _last_part(identifier: str) -> str:
        return identifier.rpartition(".")[2]
