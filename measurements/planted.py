"""Plants mistakes in Blender's own scripts, one in each copy, and asks the checker for them.

``python -m measurements --only planted`` plants 1,000, from a fixed seed, of seven kinds: an attribute, an operator, a
keyword, a value of an enumeration and a socket that do not exist, an assignment to what is read-only, and a wrong
argument (too many, one that is required left out, a text for a number or the other way round). Where they are planted
is told by :mod:`measurements.planted_places`, which does not ask the checker. A mistake is found when the copy has a
finding at its line that the script has not.

Wrong names are of three sorts: misspelt, made up from words of the API, and real ones of another owner. Nothing that is
planted exists where it stands, nor in a class below.
"""

from __future__ import annotations

import ast
import random
import time
from collections import Counter, defaultdict
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.usage.scripts import blender_scripts, read_script
from kb_check.checker import Checker
from kb_check.text.salvage import parses
from measurements.blender_scripts import scripts_folder, why_none
from measurements.planted_places import Place, Places
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from kb_build.symbols.records import Parameter
    from kb_check.findings import Finding
    from measurements.setting import Setting

KINDS = ("attribute", "operator", "keyword", "value", "socket", "read-only", "argument")
MISTAKES = 1_000
_QUICK = 140
_SEED = 14
_MOST_OF_SYMBOL = 4  # places of one symbol, of one kind
_LONGEST_SCRIPT = 2_500  # lines
_HEADER = ("kind", "planted", "found", "share")
_WORDS = ("use", "size", "mode", "active", "scale", "show", "auto", "count", "type", "level", "is", "color")
_NOT_A_VALUE = {"int": '"three"', "float": '"three"', "boolean": '"yes, please"', "string": "7", "enum": "7"}
_VALUES = {"int": "3", "float": "0.5", "boolean": "True", "string": '"x"', "enum": ""}


@dataclass(frozen=True, slots=True)
class Planted:
    """A copy of a script with one mistake: its kind, the script's name, the copy's text, and the mistake's line."""

    kind: str
    script: str
    code: str
    line: int
    written: str


@dataclass(frozen=True, slots=True)
class _Change:
    """A span of the script (lines from 1, columns in bytes) and what is written there."""

    start: tuple[int, int]
    end: tuple[int, int]
    text: str
    line: int


def plant(base: Path, folder: Path, count: int, seed: int = _SEED) -> Iterator[Planted]:
    """Plants mistakes in the scripts below a folder, the same number of each kind as far as there are places."""
    with closing(BaseSymbols(base)) as symbols:
        planter = _Planter(Places(symbols), random.Random(seed))
        scripts: dict[str, str] = {}
        places: defaultdict[str, list[tuple[str, Place]]] = defaultdict(list)
        for script in blender_scripts(folder):
            code = read_script(script.path)
            if code.count("\n") > _LONGEST_SCRIPT:
                continue
            try:
                tree = ast.parse(code)
            except (SyntaxError, ValueError):
                continue
            scripts[script.name] = code
            for place in planter.places.of(tree):
                for kind in _KINDS_OF_PLACE[place.kind]:
                    places[kind].append((script.name, place))
        for number, kind in enumerate(KINDS):
            wanted = (count + len(KINDS) - 1 - number) // len(KINDS)
            yield from planter.of_kind(kind, places[kind], scripts, wanted)


_KINDS_OF_PLACE: dict[str, tuple[str, ...]] = {
    "attribute": ("attribute", "read-only"), "operator": ("operator",), "keyword": ("keyword", "argument"),
    "value": ("value",), "socket": ("socket",), "call": ("argument",),
}  # fmt: skip


class _Planter:
    def __init__(self, places: Places, chance: random.Random) -> None:
        self.places = places
        self.chance = chance

    def of_kind(
        self, kind: str, places: list[tuple[str, Place]], scripts: dict[str, str], wanted: int
    ) -> Iterator[Planted]:
        """Mistakes of one kind; places are used again, with other mistakes, where there are too few."""
        change: Callable[[Place], _Change | None] = {
            "attribute": self._attribute, "operator": self._attribute, "keyword": self._keyword,
            "value": self._value, "socket": self._socket, "read-only": self._read_only, "argument": self._argument,
        }[kind]  # fmt: skip
        places = list(places)
        done: set[tuple[str, _Change]] = set()
        for turn in range(12):
            self.chance.shuffle(places)
            of_symbol: Counter[str] = Counter()
            for script, place in places:
                if len(done) >= wanted:
                    return
                name = place.symbol.path
                if of_symbol[name] >= _MOST_OF_SYMBOL * (turn + 1):
                    continue
                made = change(place)
                if made is None or (script, made) in done:
                    continue
                of_symbol[name] += 1
                code = _changed(scripts[script], made)
                if parses(code):
                    done.add((script, made))
                    yield Planted(kind, script, code, made.line, made.text.strip())

    # Names.

    def _wrong(self, name: str, exists: Callable[[str], bool], others: Iterable[str]) -> str | None:
        """A name that does not exist: misspelt, made up, or another owner's."""
        for _ in range(20):
            sort = self.chance.randrange(3)
            if sort == 0:
                found = self._misspelt(name)
            elif sort == 1:
                word = self.chance.choice(_WORDS)
                found = self.chance.choice((f"{word}_{name}", f"{name}_{word}", f"{name}s"))
            else:
                names = sorted(others)
                found = self.chance.choice(names) if names else f"{name}_{self.chance.choice(_WORDS)}"
            if found != name and found.isidentifier() and not exists(found):
                return found
        return None

    def _misspelt(self, name: str) -> str:
        at = self.chance.randrange(len(name))
        match self.chance.randrange(3):
            case 0:
                return name[:at] + name[at + 1 :]
            case 1:
                return name[:at] + name[at] + name[at:]
            case _:
                return name[:at] + name[at + 1 : at + 2] + name[at] + name[at + 2 :]

    def _attribute(self, place: Place) -> _Change | None:
        node = place.node
        assert isinstance(node, ast.Attribute)
        owner = place.owner
        classes = [owner, *self.places.below(owner)]

        def exists(name: str) -> bool:
            return any(self.places.member(cls, name) for cls in classes) or hasattr(object, name)

        others = (symbol.name for symbol in self.places.members("bpy.types.Object") if "." not in symbol.name)
        if place.kind == "operator":
            others = (symbol.name for symbol in self.places.members("bpy.ops.object"))
        name = self._wrong(node.attr, exists, others)
        end = node.end_lineno, node.end_col_offset
        if name is None or end[0] is None or end[1] is None:
            return None
        start = end[0], end[1] - len(node.attr.encode())
        return _Change(start, (end[0], end[1]), name, end[0])

    def _keyword(self, place: Place) -> _Change | None:
        node = place.node
        assert isinstance(node, ast.keyword)
        assert node.arg
        names = {parameter.name for parameter in place.symbol.parameters}
        if any(name.startswith("*") for name in names):
            return None
        name = self._wrong(
            node.arg, names.__contains__, {"size", "radius", "location", "name", "type", "value"}
        )
        end = node.lineno, node.col_offset + len(node.arg)
        return _Change((node.lineno, node.col_offset), end, name, node.lineno) if name else None

    def _value(self, place: Place) -> _Change | None:
        row = place.parameter or place.symbol
        values = {item.identifier for item in row.enum_items}
        computed = place.parameter is None and place.symbol.enum_computed
        if len(values) < 2 or computed:
            return None
        assert isinstance(place.node, ast.Constant)
        text = self._wrong(
            str(place.node.value), values.__contains__, {"NONE", "DEFAULT", "AUTO", "OBJECT", "CUSTOM"}
        )
        return self._text(place.node, text)

    def _socket(self, place: Place) -> _Change | None:
        sockets = [symbol for symbol in self.places.members(place.owner) if symbol.kind == "socket"]
        names = {symbol.name for symbol in sockets} | {symbol.label for symbol in sockets}
        assert isinstance(place.node, ast.Constant)
        wrong = str(place.node.value)
        for _ in range(20):
            wrong = self.chance.choice((
                self._misspelt(str(place.node.value)), f"{place.node.value} Color", "Strength", "Specular", "Vector",
                "Alpha", "Value", "Surface",
            ))  # fmt: skip
            if wrong not in names and wrong != "Fac":
                return self._text(place.node, wrong)
        return None

    @staticmethod
    def _text(node: ast.Constant, text: str | None) -> _Change | None:
        if text is None or node.end_lineno != node.lineno or node.end_col_offset is None:
            return None
        start, end = (node.lineno, node.col_offset), (node.lineno, node.end_col_offset)
        return _Change(start, end, repr(text), node.lineno)

    # What is done with it.

    def _read_only(self, place: Place) -> _Change | None:
        """An assignment, in a line of its own before the statement, to a read-only member of an owner."""
        node, statement = place.node, place.statement
        assert isinstance(node, ast.Attribute)
        if not isinstance(statement, (ast.Assign, ast.Expr, ast.Return, ast.AugAssign)):
            return None
        members = [
            symbol for symbol in self.places.members(place.owner)
            if READ_ONLY in symbol.flags and symbol.type in _VALUES and symbol.kind == "property"
            and not symbol.array and symbol.name.isidentifier()
        ]  # fmt: skip
        if not members:
            return None
        symbol = self.chance.choice(members)
        owner = ast.unparse(node.value)
        indent = " " * statement.col_offset
        at = statement.lineno, 0
        value = next((repr(item.identifier) for item in symbol.enum_items), _VALUES[symbol.type] or '"x"')
        text = f"{indent}{owner}.{symbol.name} = {value}\n"
        return _Change(at, at, text, statement.lineno)

    def _argument(self, place: Place) -> _Change | None:  # noqa: PLR0911 - one return a mistake
        if place.parameter is not None:
            return self._wrong_type(place, place.parameter)
        call = place.node
        assert isinstance(call, ast.Call)
        if call.end_lineno is None or call.end_col_offset is None:
            return None
        parameters = [p for p in place.symbol.parameters if p.name not in {"self", "cls"}]
        starred = any(isinstance(argument, ast.Starred) for argument in call.args) or any(
            word.arg is None for word in call.keywords
        )
        if starred or any(p.name.startswith("*") for p in parameters) or place.symbol.kind != "function":
            return None
        if not self._has_signature(place):
            return None
        required = [p for p in parameters if p.required]
        first = call.args[0] if call.args else None
        if (
            first is not None
            and len(call.args) + len(call.keywords) == len(required)
            and self.chance.random() < 0.5
        ):
            # All that are given are required: the first one goes.
            if len(call.args) + len(call.keywords) > 1 or first.end_lineno != call.end_lineno:
                return None
            start, end = (first.lineno, first.col_offset), (first.end_lineno or 0, first.end_col_offset or 0)
            return _Change(start, end, "", call.lineno) if call.lineno == first.lineno else None
        if call.keywords or len(call.args) > len(parameters) or call.end_lineno != call.lineno:
            return None
        more = ", ".join(["None"] * (len(parameters) - len(call.args) + 1))
        at = call.end_lineno, call.end_col_offset - 1
        return _Change(at, at, f", {more}" if call.args else more, call.lineno)

    @staticmethod
    def _has_signature(place: Place) -> bool:
        """Whether what a function takes is told by RNA, which takes nothing else."""
        return place.owner.startswith("bpy.types.") and all(p.type for p in place.symbol.parameters)

    @staticmethod
    def _wrong_type(place: Place, parameter: Parameter) -> _Change | None:
        node = place.node
        assert isinstance(node, ast.keyword)
        value = node.value
        wrong = _NOT_A_VALUE.get(parameter.type)
        if wrong is None or not isinstance(value, ast.Constant) or value.end_lineno != value.lineno:
            return None
        if value.value is None or value.end_col_offset is None:
            return None
        return _Change(
            (value.lineno, value.col_offset), (value.lineno, value.end_col_offset), wrong, value.lineno
        )


def _changed(code: str, change: _Change) -> str:
    lines = code.encode().splitlines(keepends=True)
    (first, left), (last, right) = change.start, change.end
    before, behind = lines[first - 1][:left], lines[last - 1][right:]
    lines[first - 1 : last] = [before + change.text.encode() + behind]
    return b"".join(lines).decode()


def found(checker: Checker, planted: Planted, before: Counter[tuple[str, str]]) -> bool:
    """Whether the checker finds a mistake; ``before`` are the findings of the script itself."""
    at_line = [finding for finding in checker.check(planted.code) if _covers(finding, planted.line)]
    return any(count > before[key] for key, count in Counter(_key(finding) for finding in at_line).items())


def _covers(finding: Finding, line: int) -> bool:
    return finding.span.line <= line <= finding.span.end_line


def _key(finding: Finding) -> tuple[str, str]:
    return finding.rule, finding.message


def measure(setting: Setting) -> ReportPart:
    """Plants and checks; ``quick`` plants fewer."""
    if (folder := scripts_folder(setting.base)) is None:
        return ReportPart("planted", skipped=(why_none(setting.base),))
    say("planted: planting mistakes in Blender's own scripts")
    planted: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    missed: list[str] = []
    before: dict[str, Counter[tuple[str, str]]] = {}
    began = time.perf_counter()
    with Checker(setting.base) as checker:
        for mistake in plant(setting.base, folder, _QUICK if setting.quick else MISTAKES):
            if mistake.script not in before:
                findings = checker.check(read_script(folder / mistake.script))
                before[mistake.script] = Counter(_key(finding) for finding in findings)
            planted[mistake.kind] += 1
            if found(checker, mistake, before[mistake.script]):
                seen[mistake.kind] += 1
            else:
                missed.append(f"{mistake.kind}: {mistake.script}:{mistake.line}: {mistake.written}")
    say(f"planted: {planted.total()} in {time.perf_counter() - began:.0f} s")
    rows = tuple(
        (kind, f"{planted[kind]:,}", f"{seen[kind]:,}", f"{seen[kind] / max(1, planted[kind]):.3f}")
        for kind in KINDS
    )
    share = seen.total() / max(1, planted.total())
    return ReportPart(
        "planted",
        (TargetFigure("planted", share, f"{planted.total():,} mistakes, seed {_SEED}"),),
        (Table("Planted mistakes", _HEADER, rows),),
        data={"planted": dict(planted), "found": dict(seen), "missed": missed},
    )
