"""What Blender's panels ask of other properties before they show a property, or let it be set."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from kb_build.flow.blender.facts import DISCRIMINANTS
from kb_build.panels.formulas import All, Answer, Clause, Clauses, Need, Question, common, consequences
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import READ_ONLY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.flow.blender.symbols import Symbols
    from kb_build.panels.drawing import Place
    from kb_build.panels.formulas import Formula
    from kb_build.symbols.records import Symbol

# What only hides a part of a panel, or keeps the interface from changing what has an effect all the same, and what
# Blender sets itself.
_NO_SETTINGS = frozenset({"show_expanded", "expanded", "lock", "mute", "muted", "hide", "show_developer_ui"})
_UNFOLDED = "_expanded"
_STATUS = ("is_cache_", "has_cache_", "bl_")
_OF_THE_INTERFACE = (
    "UILayout",
    "Space",
    "Preferences",
    "Screen",
    "Window",
    "Area",
    "Region",
    "FileSelect",
    "Theme",
)


_NEVER: Clauses = frozenset({frozenset()})  # a clause that nothing satisfies


@dataclass(frozen=True, slots=True)
class Gating:
    """What holds wherever panels show a property, and wherever they let it be set. The second includes the first."""

    shown: Clauses
    active: Clauses


_UNASKED = Gating(frozenset(), frozenset())


def gatings_in(places: Iterable[Place], symbols: Symbols) -> dict[str, Gating]:
    """Property → what one script's panels ask of others; ``.name`` for a property of an unknown class."""
    found: dict[str, Gating] = {}
    for place in places:
        if not place.symbols and place.owner == "self":
            continue  # the script's own property
        for path in place.symbols or (f".{place.name}",):
            if len(place.symbols) > 1 and path.startswith(f"{TYPES}Space"):
                found[path] = _UNASKED  # a panel is of one editor, and which one is not known
                continue
            gates = _Gates(place, path, symbols)
            if len(place.symbols) > 1 and not gates.have_all_asked(place.active):
                continue
            shown = consequences(place.shown, gates.of)
            if shown is None:
                continue  # it is never there
            active = consequences(place.active, gates.of)
            _add(found, path, Gating(shown, _NEVER if active is None else active))
    return found


def _surely_asked(formula: Formula) -> Iterator[Question]:
    """The questions that are asked whatever the answers to others are."""
    for part in formula.parts if isinstance(formula, All) else (formula,):
        if isinstance(part, Answer):
            yield part.question


def merged(parts: Iterable[Mapping[str, Gating]]) -> dict[str, Gating]:
    """What the panels of several scripts ask, together."""
    found: dict[str, Gating] = {}
    for part in parts:
        for path, gating in part.items():
            _add(found, path, gating)
    return found


def settled(found: Mapping[str, Gating], symbols: Symbols) -> dict[str, Gating]:
    """What all scripts ask: what a place of an unknown class asks counts for every property of that name."""
    certain: dict[str, Gating] = {}
    for path, gating in found.items():
        owner, _, name = path.rpartition(".")
        if owner:
            certain[path] = gating
            if unknown := found.get(f".{name}"):
                known = Gating(
                    *(_of_class(clauses, owner, symbols) for clauses in (unknown.shown, unknown.active))
                )
                _add(certain, path, known)
    return certain


def _of_class(clauses: Clauses, cls: str, symbols: Symbols) -> Clauses:
    """Clauses about an object of an unknown class as ones about a class's."""
    lineage = [*_bases(cls, symbols)]
    found: list[Clause] = []
    for clause in clauses:
        needs = [
            replace(need, gate=gate) for need in clause if (gate := _member(need.gate, lineage, symbols))
        ]
        if len(needs) == len(clause):
            found.append(frozenset(needs))
    return frozenset(found)


def _member(gate: str, lineage: Iterable[str], symbols: Symbols) -> str:
    """The path of a gate that may be only a name; empty for one that the class does not have."""
    if not gate.startswith("."):
        return gate
    return next((cls + gate for cls in lineage if symbols.symbol(cls + gate)), "")


def _bases(cls: str, symbols: Symbols) -> Iterator[str]:
    while symbol := symbols.symbol(cls):
        yield cls
        cls = symbol.base


def _add(found: dict[str, Gating], path: str, gating: Gating) -> None:
    before = found.get(path)
    if before is not None:
        gating = Gating(common(before.shown, gating.shown), common(before.active, gating.active))
    found[path] = gating


class _Gates:
    """Names the properties that questions are about, as seen from a property that a panel shows."""

    def __init__(self, place: Place, path: str, symbols: Symbols) -> None:
        self._owner = place.owner
        self._cls = path.rpartition(".")[0]
        self._path = path
        self._symbols = symbols
        self._lineage = list(_bases(self._cls, symbols))

    def of(self, question: Question) -> str:
        """The property that a question is about; empty for one that is not to be told."""
        if not question.symbols:
            return self._of_unknown(question)
        found = [path for path in question.symbols if self._fits(path, question)]
        if len(question.symbols) > 1:  # which of several other things it is, is not known
            found = [path for path in found if path.rpartition(".")[0] in self._lineage]
        return found[0] if len(found) == 1 else ""

    def have_all_asked(self, formula: Formula) -> bool:
        """Whether the property's class has all that is surely asked of the thing, which may be of several classes."""
        return all(
            _member(question.text[len(self._owner) :], self._lineage, self._symbols)
            for question in _surely_asked(formula)
            if question.symbols and question.owner == self._owner
        )

    def _of_unknown(self, question: Question) -> str:
        """``.name`` of a property of the same object, whose class is not known either."""
        is_own = not self._cls and question.owner == self._owner
        return question.text[len(question.owner) :] if is_own else ""

    def _fits(self, path: str, question: Question) -> bool:
        symbol = self._symbols.symbol(path)
        if symbol is None or path == self._path:
            return False
        is_related = symbol.owner in self._lineage
        if not self._is_setting(symbol, is_own=is_related):
            return False
        if is_related != (question.owner == self._owner):
            # Another object of this class, or one that has a member of this name by chance.
            return False
        is_within = self._owner == question.text or self._owner.startswith(
            (f"{question.text}.", f"{question.text}[")
        )
        tells_class = symbol.name in DISCRIMINANTS and (
            (is_related and symbol.owner != self._cls) or self._owner.startswith(f"{question.owner}.")
        )
        return not is_within and not tells_class

    @staticmethod
    def _is_setting(symbol: Symbol, *, is_own: bool) -> bool:
        cls = symbol.owner.removeprefix(TYPES)
        return (
            symbol.kind == "property"
            and READ_ONLY not in symbol.flags
            and symbol.name not in _NO_SETTINGS
            and not symbol.name.endswith(_UNFOLDED)
            and not symbol.name.startswith(_STATUS)
            and (is_own or (symbol.type != "pointer" and not cls.startswith(_OF_THE_INTERFACE)))
        )


def to_rows(gating: Gating) -> list[Any]:
    """As JSON has it."""
    return [
        [
            [[need.gate, need.relation, sorted(need.values), need.is_in] for need in clause]
            for clause in clauses
        ]
        for clauses in (gating.shown, gating.active)
    ]


def from_rows(rows: list[Any]) -> Gating:
    """The inverse of :func:`to_rows`. Raises ValueError or TypeError for what is not of its making."""
    shown, active = (
        frozenset(
            frozenset(
                Need(gate, relation, frozenset(values), is_in) for gate, relation, values, is_in in clause
            )
            for clause in clauses
        )
        for clauses in rows
    )
    return Gating(shown, active)
