"""What a caller typed → the symbols and pages that it names.

Spellings, calls, expressions, error messages, enum values, addresses: everything that names something.
What only describes something is left to the search.
"""

from __future__ import annotations

import builtins
import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.analysis import STOP_WORDS, key, stem, terms, words
from kb_build.schema import FORM_LABEL, FORM_NAME, FORM_PATH, FORM_SHORT
from kb_serve.addresses import addressed, page_named
from kb_serve.chains import Chain, find_chains
from kb_serve.corrections import Correction, Corrector, Drift, Drifts, nearest
from kb_serve.reader import TYPES, Entry, Reader
from kb_serve.walk import Walked, Walker

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_HAS_NO = re.compile(r"['\"](?P<owner>[\w.]+)['\"] object has no attribute ['\"](?P<name>\w+)['\"]")
_MODULE_HAS_NO = re.compile(r"module ['\"](?P<owner>[\w.]+)['\"] has no attribute ['\"](?P<name>\w+)['\"]")
_BAD_KEY = re.compile(r"\bkey \"(?P<name>[^\"]+)\" not found")
_BAD_ENUM = re.compile(r"enum \"(?P<name>[^\"]*)\" not found in \((?P<items>[^)]*)\)")
_BAD_KEYWORD = re.compile(r"keyword \"(?P<name>\w+)\" unrecognized")
_POLL = re.compile(r"Operator (?P<path>bpy\.ops\.\w+\.\w+)\.poll\(\)")
_BOILERPLATE = re.compile(
    r"bpy_struct: item\.attr\s*=\s*val:|bpy_prop_collection\[key\]:|has no attribute '\w+'"
)
_FILE_PATH = re.compile(r"""(?<!\[)(['"])[^'"\n]*/[^'"\n]*\1""")
_QUOTED = re.compile(r"'([^'\n]{2,60})'|\"([^\"\n]{2,60})\"")
_CAPITALS = re.compile(r"(?<![\w.])[A-Z][A-Z0-9_]{2,}(?![\w.(])")
_MEMBER = re.compile(r"\s*(?:->|→|::)\s*")
_ERROR = re.compile(r"\b[A-Z]\w*(?:Error|Exception|Warning)\b:?")

_FEW = 3
_MANY = 12
_SHORTEST_NAME = 4
_NEARLY = 0.9  # how alike a class must be for a name to be its misspelling, not a variable's
_OTHERWISE = 0.85  # how sure a name is that shares only its key with what was typed
_CLEAR = 0.85  # a variable's name that hardly means another class
_OWN_CLASS = 0.2  # from this fit on, a variable's name speaks for the class at all
_FITTING = 0.5  # how far the words around a bare value must fit the property that takes it

# Python's own names, which are nobody's API.
_NOT_API = frozenset({*dir(builtins), "NoneType"})


@dataclass(frozen=True, slots=True)
class Match:
    """One thing that the query names. ``sure`` is 1 for an exact spelling and less for a likely reading."""

    id: str
    sure: float
    why: str


@dataclass(frozen=True, slots=True)
class Missing:
    """A name that does not exist on the class (or in the module) ``owner``; ``owner`` may be empty."""

    name: str
    owner: str = ""


@dataclass(slots=True)
class Identified:
    """What was recognised: ``matches`` best first, and what was wrong with the names that were typed."""

    matches: list[Match] = field(default_factory=list)
    missing: list[Missing] = field(default_factory=list)
    corrections: list[Correction] = field(default_factory=list)
    drifts: list[Drift] = field(default_factory=list)

    def add(self, identifier: str, sure: float, why: str) -> None:
        """Adds a match, or raises the certainty of the same one."""
        for number, match in enumerate(self.matches):
            if match.id == identifier:
                if sure > match.sure:
                    self.matches[number] = Match(identifier, sure, why)
                return
        self.matches.append(Match(identifier, sure, why))

    @property
    def best(self) -> Match | None:
        """The surest match."""
        return max(self.matches, key=lambda match: match.sure, default=None)


def _strangeness(text: str, identifier: str) -> int:
    """How far an identifier is from what was typed, of those that share its key (see analysis.key)."""
    if "_OT_" in text.upper():  # its class says nothing that the operator does not
        return 0 if identifier.startswith("bpy.ops.") else 1
    if identifier == f"bpy.ops.{text}":  # a module of operators is rarely what a bare word means
        return 2
    if f".{identifier}".endswith(f".{text}"):
        return 0
    if f".{identifier}".lower().endswith(f".{text.lower()}"):
        return 1
    return 2 if identifier.removeprefix(TYPES).count(".") == text.removeprefix(TYPES).count(".") else 3


def _is_api(chain: Chain) -> bool:
    """Whether a chain may be Blender's; ``object.location`` is, though Python has an ``object`` too."""
    return chain.root not in _NOT_API or bool(chain.attributes)


def _called(text: str) -> str:
    """``f`` of ``f(a, b)``; the text itself where it is no call, or more follows upon it."""
    start, depth = text.find("("), 0
    if start < 0 or not text.endswith(")"):
        return text
    for position, char in enumerate(text[start:], start):
        depth += (char == "(") - (char == ")")
        if depth == 0 and position + 1 < len(text):
            return text
    return text[:start]


class Identifier:
    """Recognises names against one base."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._walker = Walker(reader)
        self._corrector = Corrector(reader, self._walker)
        self._drifts = Drifts(reader)

    def identify(self, query: str) -> Identified:
        """Everything that ``query`` names, surest first."""
        found = Identified()
        for identifier in addressed(query, self._reader):
            found.add(identifier, 1.0, "address")
        self._whole(query, found)
        if found.best is None or found.best.sure < 1:
            self._errors(query, found)
            chains = find_chains(_FILE_PATH.sub(" ", _BOILERPLATE.sub(" ", query)))
            self._chains(chains, found)
            self._class_with_member(chains, found)
            self._api_words(chains, found)
            self._enum_values(query, found)
            self._explain_missing(found)
        found.matches.sort(key=lambda match: -match.sure)
        return found

    # Whole spellings

    def _symbol(self, path: str, found: Identified, why: str) -> None:
        if path and self._reader.entry(path):
            found.add(path, 1.0, why)

    def _whole(self, query: str, found: Identified) -> None:
        """The query as one spelling of one thing."""
        text = query.strip().strip("`'\"").rstrip(".:;,?!")
        for path in (text, f"bpy.{text}"):
            if self._reader.entry(path):
                found.add(path, 1.0, "exact")
                return
        if slug := page_named(text, self._reader):
            found.add(slug, 1.0, "exact")
            return
        called = _MEMBER.sub(".", _called(text))
        if " " in text:
            self._labelled(text, found)
        rows = self._reader.by_key(key(called))
        if rows:
            self._spelled(called, rows, found)
        if found.best is None or found.best.sure < 1:
            found.drifts.extend(self._drifts.spelled(called))

    def _spelled(self, text: str, rows: list[tuple[int, str]], found: Identified) -> None:
        """Symbols and pages that share the key of what was typed; the fuller the spelling, the surer."""
        dotted = "." in text
        plain = " " not in text.strip()
        strange = {identifier: _strangeness(text, identifier) for _, identifier in rows}
        typed = 0 in strange.values() or self._is_enum_item(text) or self._is_former(text)
        for form, identifier in sorted(rows, key=lambda row: strange[row[1]]):
            if form == FORM_PATH or (form == FORM_SHORT and "/" not in identifier):
                # ``view_layers`` and ``ViewLayers`` share a key: what is written otherwise was hardly meant.
                found.add(identifier, _OTHERWISE if typed and strange[identifier] > 1 else 1.0, "exact")
            elif form in {FORM_NAME, FORM_LABEL} and not dotted:
                same = self._last_part(identifier) == text
                found.add(identifier, 0.9 if same and plain and "_" in text else 0.7, "name")
            else:
                found.add(identifier, 0.75, "title")

    def _labelled(self, text: str, found: Identified) -> None:
        """The classes and operators that the interface calls just so; of modifiers, what Blender names new ones."""
        entries = [
            entry
            for label in (f"{text} Modifier", f"{text} Constraint", text)
            for form, identifier in self._reader.by_key(key(label))
            if form == FORM_LABEL and (entry := self._reader.entry(identifier)) and entry.label == label
        ]
        named = [entry for entry in entries if entry.kind in {"class", "operator"}]
        for rank, entry in enumerate(named[:_FEW]):
            found.add(entry.path, 0.9 if len(named) == 1 else 0.83 - 0.01 * rank, "label")

    def _is_enum_item(self, text: str) -> bool:
        if not (text.isupper() and "_" in text):
            return False
        return any(text == identifier for _, identifier, _ in self._reader.enum_owners(key(text)))

    def _is_former(self, text: str) -> bool:
        return any(self._reader.removed(path) for path in (text, TYPES + text))

    @staticmethod
    def _last_part(identifier: str) -> str:
        return identifier.rpartition(".")[2]

    # Error messages

    def _errors(self, query: str, found: Identified) -> None:
        for pattern in (_HAS_NO, _MODULE_HAS_NO):
            for match in pattern.finditer(query):
                owner = self._class_path(match["owner"])
                if former := self._former_owner(match["owner"], match["name"], owner):
                    found.drifts.extend(former)
                elif owner and not self._walker.member(owner, match["name"]):
                    found.missing.append(Missing(match["name"], owner))
                    found.add(owner, 0.6, "error message")
        for match in _POLL.finditer(query):
            self._symbol(match["path"], found, "error message")
        for match in _BAD_KEY.finditer(query):
            found.missing.append(Missing(match["name"]))
        for match in _BAD_ENUM.finditer(query):
            for owner, _ in self._owners_of_items(re.findall(r"'([^']+)'", match["items"])):
                found.add(owner.partition("(")[0], 0.95, "error message")
                break
        for match in _BAD_KEYWORD.finditer(query):
            found.missing.append(Missing(match["name"]))

    def _former_owner(self, written: str, name: str, owner: str) -> list[Drift]:
        """The members, or else the classes, that other versions had under a name that is not a class here."""
        if self._reader.entry(TYPES + written):
            return []
        members = [*self._drifts.spelled(f"{written}.{name}")]
        return members if members or owner else [*self._drifts.spelled(written)]

    def _class_path(self, name: str) -> str:
        for candidate in (TYPES + name, name):
            if self._reader.entry(candidate):
                return candidate
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind in {"class", "module"}:
                return identifier
        return ""

    # Code

    def _chains(self, chains: list[Chain], found: Identified) -> None:
        code = [chain for chain in chains if chain.is_code and _is_api(chain)]
        prose = {stem(word) for chain in chains if not chain.is_code for word in words(chain.root)}
        for position, chain in enumerate(code):
            later = 0.02 * min(position, 5)
            readings = self._walker.walk(chain)
            if self._former(chain, readings, found):
                continue
            broken = max((walked for walked in readings if walked.missing), key=lambda w: w.fit, default=None)
            if (
                readings
                and self._trusted(chain, readings[0], broken)
                and not self._misspelt(chain, readings[0])
            ):
                self._reading(chain, readings, later, found)
            elif not self._corrected(chain, later, found):
                if broken:
                    self._broken_off(broken, later, found)
                self._loose_name(chain, prose, found)

    @staticmethod
    def _trusted(chain: Chain, walked: Walked, broken: Walked | None) -> bool:
        """Whether a reading stands on more than a guess at what a variable or a bare word is.

        A variable that clearly bears a class' name, and lacks the one attribute, is believed before a class that
        merely has it.
        """
        if not walked.complete:
            return False
        if broken and len(chain.attributes) == 1 and broken.fit >= _CLEAR and walked.fit < 0.5:
            return False
        return walked.fit >= 1.0 or len(chain.attributes) >= (1 if walked.fit >= _OWN_CLASS else 2)

    def _misspelt(self, chain: Chain, walked: Walked) -> bool:
        """Whether what looks like a class is nearly one: ``PoimtLight`` is no variable that holds a light."""
        if walked.fit >= 1.0 or not chain.root[:1].isupper():
            return False
        meant = self._corrector.root(chain.root)
        return meant is not None and _NEARLY <= meant.similarity < 1.0

    def _former(self, chain: Chain, readings: list[Walked], found: Identified) -> bool:
        """Whether the chain names what another version had: on the likeliest class, or under its own path."""
        if not (readings and readings[0].complete and readings[0].fit >= 0.85):
            for walked in readings:
                if drift := self._drift(chain, walked):
                    found.drifts.append(drift)
                    return True
            for drift in self._drifts.spelled(chain.dotted) if chain.steps or "_" in chain.root else ():
                found.drifts.append(drift)
                return True
        return False

    def _drift(self, chain: Chain, walked: Walked) -> Drift | None:
        """The former symbol that a broken reading stops at."""
        if "puts[" in walked.missing:
            former = self._drifts.of_member(walked.owner, walked.missing)
            return former or self._drifts.of_socket(walked.owner, walked.missing, chain.root)
        return (
            self._drifts.of_member(walked.owner, walked.missing)
            if walked.missing and walked.fit >= 0.6
            else None
        )

    def _reading(self, chain: Chain, readings: list[Walked], later: float, found: Identified) -> None:
        """The best reading of one chain, and what lies on the way to it."""
        bare = not chain.attributes  # a class with a call or an index behind it
        for rank, walked in enumerate(reading for reading in readings[:4] if reading.complete):
            sure = 0.78 if bare and chain.steps else 0.97
            found.add(walked.symbols[-1], sure - 0.04 * rank - later, "expression")
        for step, symbol in enumerate(reversed(readings[0].symbols[:-1])):
            found.add(symbol, 0.5 - 0.05 * step - later, "on the way")

    def _corrected(self, chain: Chain, later: float, found: Identified) -> bool:
        """Reads a chain with its misspelt names mended."""
        if not chain.steps and not chain.root[:1].isupper():
            return False
        mended = self._corrector.corrected(chain)
        if mended is None:
            return False
        walked, corrections = mended
        found.corrections += corrections
        found.add(
            walked.symbols[-1], 0.93 * min(c.similarity for c in corrections) ** 0.25 - later, "correction"
        )
        for step, symbol in enumerate(reversed(walked.symbols[:-1])):
            found.add(symbol, 0.5 - 0.05 * step - later, "on the way")
        return True

    @staticmethod
    def _broken_off(walked: Walked, later: float, found: Identified) -> None:
        """As far as a chain could be followed."""
        found.missing.append(Missing(walked.missing, walked.owner))
        for step, symbol in enumerate(reversed(walked.symbols)):
            socket = step == 0 and symbol.endswith(
                '"]'
            )  # one that takes no value of its own is still what was meant
            found.add(symbol, (0.93 if socket else 0.45 - 0.05 * step) - later, "on the way")

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

    def _loose_name(self, chain: Chain, prose: set[str], found: Identified) -> None:
        """A name of code without its owner (``thickness_outer``): its owners, by the words around it."""
        name = chain.attributes[-1] if chain.attributes else chain.root
        rows = [
            entry
            for form, identifier in self._reader.by_key(key(name))
            if form in {FORM_NAME, FORM_SHORT} and (entry := self._reader.entry(identifier))
        ]
        if not rows and not name.isupper() and (mended := self._corrector.member(name)):
            found.corrections.append(mended)
            rows = [entry for entry in self._reader.by_name(mended.meant) if entry.group != "ui"]
        if chain.attributes and len(rows) > _FEW:
            return  # a common name whose owner was given, and does not have it
        for rank, entry in enumerate(sorted(rows, key=lambda entry: -self._affinity(entry, prose))[:5]):
            sure = 0.9 if len(rows) == 1 else 0.84
            if chain.attributes and (len(rows) > 1 or "_" not in name):
                sure = 0.55
            elif entry.kind == "class" and chain.steps:
                sure = 0.8  # ``BMElemSeq[index]`` in a message: what it says about the class comes first
            found.add(entry.path, sure - 0.03 * rank, "name")

    def _api_words(self, chains: list[Chain], found: Identified) -> None:
        """Words among prose that are names and no English (``fcurves``, ``depsgraph``): likely what it is about."""
        prose = {stem(word) for chain in chains for word in words(chain.root)}
        for chain in chains:
            name = chain.root
            if chain.is_code or len(name) < _SHORTEST_NAME or not name.islower() or self._is_english(name):
                continue
            rows = [
                entry
                for entry in self._reader.by_name(name)
                if entry.group != "ui" and entry.kind != "module"
            ]
            ranked = sorted(rows, key=lambda entry: -self._affinity(entry, prose))
            for rank, entry in enumerate(ranked[:_FEW]):
                found.add(entry.path, 0.79 - 0.03 * rank, "name")

    def _is_english(self, word: str) -> bool:
        forms = (word, word.removesuffix("s"))
        return word in STOP_WORDS or any(self._reader.near(form) is not None for form in forms)

    def _affinity(self, entry: Entry, prose: set[str]) -> float:
        """How many of the words around a name belong to its owner, and how usual the owner is."""
        owner = self._reader.entry(entry.owner)
        about = set(terms(entry.owner.replace("bpy.types.", "") + " " + (owner.label if owner else "")))
        about |= set(terms(entry.label))
        usual = 0.2 if entry.group != "ui" and entry.kind in {"property", "function", "operator"} else 0.0
        return len(about & prose) - 0.05 * len(about) + usual

    def _class_with_member(self, chains: list[Chain], found: Identified) -> None:
        """``SoftBodySettings goal_spring``: a class and one of its members, side by side."""
        classes = [
            entry
            for chain in chains
            if not chain.steps and (entry := self._reader.entry(TYPES + chain.root)) and entry.kind == "class"
        ]
        for cls in classes:
            for chain in chains:
                if chain.steps or chain.root == cls.name:
                    continue
                member = self._walker.member(cls.path, chain.root)
                if member and ("_" in chain.root or chain.root not in STOP_WORDS):
                    found.add(member.path, 0.96, "class and member")

    # Enumerations

    def _enum_values(self, query: str, found: Identified) -> None:
        text = _ERROR.sub(" ", query)
        quoted = [a or b for a, b in _QUOTED.findall(text)]
        values = list(dict.fromkeys([*quoted, *_CAPITALS.findall(text)]))
        if not values:
            return
        for value in quoted:
            for entry in self._reader.by_name(value):
                if entry.kind == "class":
                    found.add(entry.path, 0.82, "quoted name")
        rest = text
        for value in values:
            rest = rest.replace(value, " ")
        around = set(terms(rest))
        alone = not around
        for rank, (owner, share) in enumerate(self._owners_of_items(values, around)):
            if rank >= 5:
                break
            fits = alone or quoted or self._owner_fit(owner, around) >= _FITTING
            sure = (0.97 if alone else 0.9 if fits else 0.45) * (0.6 + 0.4 * share) - 0.03 * rank
            found.add(owner.partition("(")[0], sure, "enum item")

    def _owners_of_items(
        self, values: Iterable[str], around: set[str] | None = None
    ) -> Iterator[tuple[str, float]]:
        """(owner, share of the values it has), the fullest first, then the one the other words fit."""
        wanted = list(values)
        held: dict[str, set[str]] = defaultdict(set)
        for value in wanted:
            for owner, identifier, name in self._reader.enum_owners(key(value)):
                if value in {identifier, name}:
                    held[owner].add(value)
        for owner in sorted(
            held, key=lambda o: (-len(held[o]), -self._owner_fit(o, around or set()), len(o), o)
        ):
            yield owner, len(held[owner]) / max(1, len(wanted))

    def _owner_fit(self, owner: str, around: set[str]) -> float:
        path, _, parameter = owner.partition("(")
        entry = self._reader.entry(path)
        if entry is None:
            return -1.0
        about = set(terms(f"{entry.name} {entry.label} {parameter}"))
        beyond = set(terms(entry.owner.replace("bpy.types.", "").replace("bpy.ops", "")))
        return len(about & around) + 0.6 * len(beyond & around) - (0.3 if parameter else 0.0)
