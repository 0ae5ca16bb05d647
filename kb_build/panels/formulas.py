"""Conditions as formulas over questions, and what follows from them whatever the answers that nobody knows."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from math import prod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

TRUE_VALUE = "True"
YES = frozenset({TRUE_VALUE})
_MOST_ANSWERS = 1 << 12  # combinations of answers that are looked at together
_MOST_PARTS = 300  # of a formula
_MOST_NEEDS = 2  # of one clause that is not of switches alone
_SWITCHES = 3, 4  # of which one must be on
_MOST_SWITCHES = 8  # that are looked at together
_MOST_CLAUSES = 12


@dataclass(frozen=True, slots=True)
class Question:
    """What a condition asks of an expression, whose ``text`` and ``relation`` tell it from others.

    ``symbols`` are the properties that the expression can be, read from ``owner``; none for what is no property.
    ``relation`` is empty where the value is asked for: of a truth value ``True``, of an enumeration its identifiers.
    Otherwise it is a yes-or-no question: ``is set``, ``> 0``.
    """

    text: str
    owner: str = ""
    symbols: tuple[str, ...] = ()
    relation: str = ""


@dataclass(frozen=True, slots=True)
class Answer:
    """Holds if the value is one of ``values``, or none of them where ``is_in`` is False."""

    question: Question
    values: frozenset[str]
    is_in: bool = True


@dataclass(frozen=True, slots=True)
class All:
    """Holds if every part holds."""

    parts: tuple[Formula, ...] = ()


@dataclass(frozen=True, slots=True)
class Either:
    """Holds if any part holds."""

    parts: tuple[Formula, ...] = ()


Formula = Answer | All | Either
TRUE = All()
FALSE = Either()


def all_of(*parts: Formula) -> Formula:
    """The conjunction."""
    return _combined(All, FALSE, parts)


def either_of(*parts: Formula) -> Formula:
    """The disjunction."""
    return _combined(Either, TRUE, parts)


def _combined(kind: type[All | Either], decisive: Formula, parts: Iterable[Formula]) -> Formula:
    """Parts in one formula of a ``kind``, flat and each once; ``decisive`` if that is among them."""
    kept: dict[Formula, None] = {}
    for part in parts:
        if part == decisive:
            return decisive
        kept.update(dict.fromkeys(part.parts if isinstance(part, kind) else (part,)))
    return next(iter(kept)) if len(kept) == 1 else kind(tuple(kept))


def negated(formula: Formula) -> Formula:
    """The opposite."""
    match formula:
        case Answer():
            return Answer(formula.question, formula.values, not formula.is_in)
        case All():
            return either_of(*map(negated, formula.parts))
        case Either():
            return all_of(*map(negated, formula.parts))


def chosen(condition: Formula, first: Formula, second: Formula) -> Formula:
    """``first`` where the condition holds, else ``second``."""
    if first == second:
        return first
    return either_of(all_of(condition, first), all_of(negated(condition), second))


def is_large(formula: Formula) -> bool:
    """Whether a formula has more parts than are worth reading: branches can double it each time."""
    queue, left = [formula], _MOST_PARTS
    while queue and left:
        part = queue.pop()
        left -= 1
        if not isinstance(part, Answer):
            queue += part.parts
    return bool(queue)


@dataclass(frozen=True, slots=True)
class Need:
    """What a property must be: one of ``values``, or none of them where ``is_in`` is False.

    ``relation``, where it is not empty, is a yes-or-no question whose answer is meant instead (see Question).
    """

    gate: str
    relation: str
    values: frozenset[str]
    is_in: bool = True


Clause = frozenset[Need]  # one of them holds
Clauses = frozenset[Clause]  # all of them hold


def consequences(formula: Formula, gate_of: Callable[[Question], str]) -> Clauses | None:
    """What surely holds of properties where a formula holds; None where it never does.

    ``gate_of`` names the property that a question is about; empty for what is not to be told.
    """
    values: dict[Question, set[str]] = {}
    _collect(formula, values)
    asked: dict[tuple[str, str], list[Question]] = {}
    for question in values:
        if gate := gate_of(question):
            asked.setdefault((gate, question.relation), []).append(question)
    # Two objects of one class would both be called by its name.
    told = {questions[0]: gate for (gate, _), questions in asked.items() if len(questions) == 1}
    return _follow(formula, values, told)


def _collect(formula: Formula, values: dict[Question, set[str]]) -> None:
    """Question → the values that a formula names."""
    if isinstance(formula, Answer):
        values.setdefault(formula.question, set()).update(formula.values)
    else:
        for part in formula.parts:
            _collect(part, values)


def _follow(
    formula: Formula, values: Mapping[Question, set[str]], told: Mapping[Question, str]
) -> Clauses | None:
    own: dict[Question, set[str]] = {}
    _collect(formula, own)
    if prod(len(values[question]) + 1 for question in own) > _MOST_ANSWERS:
        if not isinstance(formula, All):
            return frozenset()
        found: list[Clause] = []
        for part in formula.parts:
            clauses = _follow(part, values, told)
            if clauses is None:
                return None
            found += clauses
        return strongest(found)
    table = _Table({question: sorted(values[question]) for question in own})
    rows = table.rows(formula)
    if not rows:
        return None
    shown = [question for question in own if question in told]
    clauses = [
        frozenset({_need(told[question], question, allowed)})
        for question in shown
        if (allowed := table.allowed(question, rows))
    ]
    for first, second in combinations(shown, 2):
        if pair := table.allowed_either(first, second, rows):
            clauses.append(
                frozenset({_need(told[first], first, pair[0]), _need(told[second], second, pair[1])})
            )
    switches = [question for question in shown if not question.relation and values[question] == {TRUE_VALUE}]
    for number in _SWITCHES if len(switches) <= _MOST_SWITCHES else ():
        clauses += [
            frozenset(_need(told[question], question, (YES, True)) for question in group)
            for group in combinations(switches, number)
            if table.has_one(group, rows)
        ]
    return strongest(clauses)


def _need(gate: str, question: Question, allowed: _Allowed) -> Need:
    return Need(gate, question.relation, *allowed)


_OTHER = "*"  # any value that no condition names
_Allowed = tuple[frozenset[str], bool]  # the values and whether they, or all others, are allowed


class _Table:
    """All combinations of answers: a bit each, set in a number where something holds."""

    def __init__(self, values: Mapping[Question, list[str]]) -> None:
        size = prod(len(named) + 1 for named in values.values())
        self._all = (1 << size) - 1
        self._columns: dict[Question, dict[str, int]] = {}
        stride = 1
        for question, named in values.items():
            period = stride * (len(named) + 1)
            repeated = self._all // ((1 << period) - 1)
            ones = (1 << stride) - 1
            self._columns[question] = {
                value: (ones << (place * stride)) * repeated for place, value in enumerate([*named, _OTHER])
            }
            stride = period

    def rows(self, formula: Formula) -> int:
        """Where a formula holds."""
        match formula:
            case Answer():
                columns = self._columns[formula.question]
                held = 0
                for value in formula.values:
                    held |= columns[value]
                return held if formula.is_in else self._all & ~held
            case All():
                held = self._all
                for part in formula.parts:
                    held &= self.rows(part)
                return held
            case Either():
                held = 0
                for part in formula.parts:
                    held |= self.rows(part)
                return held

    def allowed(self, question: Question, rows: int) -> _Allowed | None:
        """The values that a question has somewhere in ``rows``; None for any."""
        columns = self._columns[question]
        return _allowed(columns, {value for value, column in columns.items() if not column & rows})

    def has_one(self, switches: Iterable[Question], rows: int) -> bool:
        """Whether everywhere in ``rows`` at least one switch is on."""
        for switch in switches:
            rows &= ~self._columns[switch][TRUE_VALUE]
        return not rows

    def allowed_either(
        self, first: Question, second: Question, rows: int
    ) -> tuple[_Allowed, _Allowed] | None:
        """Values of two questions of which one has one of its own everywhere in ``rows``, if they are bound so."""
        columns, others = self._columns[first], self._columns[second]
        excluded = {
            (value, other)
            for value, column in columns.items()
            for other, second_column in others.items()
            if not column & second_column & rows
        }
        # What each excludes by itself is told by itself.
        excluded = {
            pair for pair in excluded if columns[pair[0]] & rows and others[pair[1]] & rows
        }  # fmt: skip
        sides = {value for value, _ in excluded}, {other for _, other in excluded}
        if len(excluded) != len(sides[0]) * len(sides[1]):
            return None
        left, right = _allowed(columns, sides[0]), _allowed(others, sides[1])
        return (left, right) if left and right else None


def _allowed(columns: Iterable[str], excluded: set[str]) -> _Allowed | None:
    """The values that are left; None where none is excluded."""
    if not excluded:
        return None
    if _OTHER in excluded:
        return frozenset(columns) - excluded, True
    return frozenset(excluded), False


def strongest(clauses: Iterable[Clause]) -> Clauses:
    """The clauses that do not follow from another one of them."""
    kept: list[Clause] = []
    for clause in sorted(set(clauses), key=lambda one: (len(one), sorted(map(repr, one)))):
        if not any(follows(clause, other) for other in kept):
            kept = [other for other in kept if not follows(other, clause)]
            kept.append(clause)
    return frozenset(kept[:_MOST_CLAUSES])


def follows(clause: Clause, other: Clause) -> bool:
    """Whether a clause holds wherever another one does."""
    return all(any(_is_narrower(need, wider) for wider in clause) for need in other)


def _is_narrower(need: Need, wider: Need) -> bool:
    return (need.gate, need.relation) == (wider.gate, wider.relation) and _either(need, wider) == wider


def _either(need: Need, other: Need) -> Need | None:
    """What holds where either of two needs of the same gate does; None where everything is allowed."""
    if need.is_in and other.is_in:
        values, is_in = need.values | other.values, True
    elif need.is_in or other.is_in:
        inside, outside = (need, other) if need.is_in else (other, need)
        values, is_in = outside.values - inside.values, False
    else:
        values, is_in = need.values & other.values, False
    return Need(need.gate, need.relation, values, is_in) if values else None


def common(first: Clauses, second: Clauses) -> Clauses:
    """What follows from either of two sets of clauses."""
    joined = (_joined(one, other) for one, other in product(first, second))
    return strongest(clause for clause in joined if clause is not None)


def _joined(first: Clause, second: Clause) -> Clause | None:
    """The disjunction of two clauses; None where it says nothing, or too much."""
    needs = {(need.gate, need.relation): need for need in first}
    for need in second:
        gate = need.gate, need.relation
        either = _either(needs[gate], need) if gate in needs else need
        if either is None:
            return None
        needs[gate] = either
    most = max(_MOST_NEEDS, len(first), len(second))
    return frozenset(needs.values()) if len(needs) <= most else None
