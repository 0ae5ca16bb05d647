"""Finds the uses of symbols in a script, and the lines that show each most clearly."""

from __future__ import annotations

import ast
import builtins
import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from kb_build.flow.analysis import analyse
from kb_build.flow.syntax.trees import children
from kb_build.flow.values.types import (
    UNKNOWN,
    ClassObject,
    Function,
    Instance,
    Operator,
    Resolution,
    ResolutionKind,
)
from kb_build.symbols.api_names import TYPES
from kb_build.usage.definitions import decorated_function, derived_class, without_comment
from kb_build.usage.scripts import PRESETS
from kb_build.usage.unfit_calls import unfit_statements

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api
    from kb_build.panels.panel_labels import PanelLabel
    from kb_build.symbols.records import SettingCondition

MOST_EXAMPLES = 3  # of one symbol
_MOST_LINES = 3
_LONGEST_LINE = 110
_LONGEST_REWRITTEN = 150  # of a statement of more lines, written as one
_MOST_COUNTED = 10  # uses of one symbol in one file: tables and generated code say little
_NEAR = 12  # lines between a name's binding and its use
_BUILTINS = frozenset(dir(builtins)) | {
    "bpy",
    "context",
    "bmesh",
    "mathutils",
    "self",
    "cls",
    "C",
    "D",
    "gpu",
}

_LAYOUT = Instance("bpy.types.UILayout")
_OF_CONTEXT = re.compile(r"\bbpy\.context\.\w+")
_CONTEXTS = ("bpy.context.", "bpy.types.Context.")
_STEP_LEFT_OUT = 0.8  # what is added for each line that prepares what is used, and that there is no room for
_OF_EDITORS = 20.0  # what is added to the cost of code that runs in some editors only
_OWN_BASE = 3.0  # the same for a class that derives from others of its script, too

# What a use is: what a part of the script stands for, or what an expression gives, or a definition does.
_UseKind = ResolutionKind | Literal["made", "given", "derived", "decorates"]
# How clearly a use shows its symbol: 0 is best. That a panel or a menu shows it does not tell how it is used.
_COSTS: dict[_UseKind, float] = {
    "store": 0.0,
    "call": 0.0,
    "item": 0.0,
    "made": 0.5,
    "derived": 0.0,
    "decorates": 0.0,
    "attribute": 3.0,
    "name": 6.0,
    "text": 1.5,
    "given": 5.0,
}


@dataclass(frozen=True, slots=True)
class Example:
    """Lines of a script that use a symbol. ``line`` counts from 1; the lower the ``cost``, the clearer."""

    cost: float
    file: str
    line: int
    code: str


@dataclass(slots=True)
class Uses:
    """The uses of one symbol: their number (up to ten a file), the number of files, and the clearest ones."""

    count: int = 0
    files: int = 0
    examples: list[Example] = field(default_factory=list[Example])

    def add(self, other: Uses) -> None:
        """Adds the uses in other files."""
        self.count += other.count
        self.files += other.files
        self.examples = clearest([*self.examples, *other.examples])


@dataclass(frozen=True, slots=True)
class SymbolUsage:
    """What the uses of symbols tell: symbol → its uses, and class → the expression that leads to an instance.

    ``names``: class, without its module → the name that Blender itself gives to a new one. ``conditions`` are what
    panels ask before they let a property be set, ``panels`` where they show which.
    """

    uses: Mapping[str, Uses] = field(default_factory=dict[str, Uses])
    reached: Mapping[str, str] = field(default_factory=dict[str, str])
    names: Mapping[str, str] = field(default_factory=dict[str, str])
    conditions: Sequence[SettingCondition] = ()
    panels: Mapping[str, Sequence[PanelLabel]] = field(default_factory=dict[str, "Sequence[PanelLabel]"])


def clearest(examples: Iterable[Example]) -> list[Example]:
    """The clearest examples, no two of the same code."""
    kept: dict[str, Example] = {}
    for example in sorted(examples, key=lambda one: (one.cost, len(one.code), one.file, one.line)):
        kept.setdefault(example.code, example)
        if len(kept) == MOST_EXAMPLES:
            break
    return list(kept.values())


def uses_in(code: str, file: str, api: Api, version: tuple[int, ...], cost: float = 0.0) -> dict[str, Uses]:
    """Symbol → its uses in a script; none where the script cannot be read. ``cost`` is added to every example's."""
    return analysed_uses(analyse(code, api, version), code, file, api, cost)


def analysed_uses(analysis: Analysis, code: str, file: str, api: Api, cost: float = 0.0) -> dict[str, Uses]:
    """The same of a script that was analysed."""
    if analysis.tree is None:
        return {}
    script = _Script(code, file, analysis, cost, api)
    unfit = unfit_statements(analysis, api.symbols)
    found: dict[str, Uses] = {}
    candidates: dict[str, list[tuple[float, ast.stmt]]] = defaultdict(list)
    for path, kind, share, resolution in _used(analysis, api):
        uses = found.get(path)
        if uses is None:
            uses = found[path] = Uses(files=1)
        if uses.count < _MOST_COUNTED and (
            kind not in {"derived", "decorates"} or not uses.count
        ):  # its base counts already
            uses.count += 1
        statement = resolution.statement
        if statement is not None and kind in _COSTS and statement not in unfit:
            step = _COSTS[kind] + 3.0 * (share - 1) + (0.0 if resolution.sure else 2.0)
            step += script.editor_cost(statement)
            candidates[path].append((step, statement))
    for path, rows in candidates.items():
        found[path].examples = script.examples(rows)
    return found


def _used(analysis: Analysis, api: Api) -> Iterator[tuple[str, _UseKind, int, Resolution]]:
    """(symbol, kind of use, number of symbols it may be, resolution) for everything that a script uses."""
    called = {node.func for node in analysis.resolutions if isinstance(node, ast.Call)}
    owners = {node.value for node in analysis.types if isinstance(node, ast.Attribute)}
    for node, resolution in analysis.resolutions.items():
        kind = resolution.kind
        if kind in {"keyword", "value", "compared"} or (kind == "attribute" and node in called):
            continue
        if isinstance(node, ast.Call) and _is_of_some(analysis.resolutions.get(node.func)):
            continue
        for path in resolution.symbols:
            # A class that is a value among others does not show how it is used.
            is_value = kind == "attribute" and node not in owners and api.is_class(path)
            yield path, "value" if is_value else kind, len(resolution.symbols), resolution
        if isinstance(node, (ast.Call, ast.Attribute)) and kind in {"call", "attribute"}:
            made = analysis.types.get(node)
            if isinstance(made, Instance) and made.sure and made.cls.startswith(TYPES):
                yield made.cls, "made" if kind == "call" else "given", 1, resolution
            elif isinstance(made, Operator):
                continue
    yield from _defined(analysis)


def _is_of_some(callee: Resolution | None) -> bool:
    """Whether only several classes below that of its owner have what is called: any of them may be meant."""
    return callee is not None and len(callee.possible) > 1 and not callee.symbols


def _defined(analysis: Analysis) -> Iterator[tuple[str, _UseKind, int, Resolution]]:
    """The same of the classes and functions that a script defines: what they derive from, and what decorates them."""
    for definition in analysis.classes:
        for base in definition.bases:
            kind = analysis.types.get(base)
            if isinstance(kind, ClassObject):
                yield kind.cls, "derived", 1, Resolution(base, "name", "", statement=definition)
    for definition in analysis.functions:
        if not isinstance(definition, (ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        for decorator in definition.decorator_list:
            kind = analysis.types.get(decorator)
            if isinstance(kind, (ClassObject, Function)):
                path = kind.cls if isinstance(kind, ClassObject) else kind.path
                yield path, "decorates", 1, Resolution(decorator, "name", "", statement=definition)


class _Script:
    """A script's lines and the places where it binds names."""

    def __init__(self, code: str, file: str, analysis: Analysis, cost: float, api: Api) -> None:
        self._lines = code.splitlines()
        self._api = api
        self._file = file
        self._analysis = analysis
        self._cost = cost
        self._scope_of: dict[ast.stmt, int] = {}
        # statement → the block that it stands in, and block → the one around it
        self._block_of: dict[ast.stmt, int] = {}
        self._around: dict[int, int] = {}
        self._statements: dict[int, list[ast.stmt]] = defaultdict(list)  # by block
        # (function, name) → line, block and text of each of its bindings
        self._bound: dict[tuple[int, str], list[tuple[int, int, str]]] = defaultdict(list)
        self._texts: dict[ast.stmt, tuple[float, int, str] | None] = {}
        self._editor_lines = set(self._lines_of_editors())
        if analysis.tree is not None:
            self._index(analysis.tree.body, 0)

    def _index(self, body: list[ast.stmt], scope: int) -> None:
        queue = [(body, scope, -1)]
        while queue:
            statements, number, around = queue.pop()
            block = len(self._around)
            self._around[block] = around
            for statement in statements:
                self._scope_of[statement] = number
                self._block_of[statement] = block
                self._statements[block].append(statement)
                inner = number
                match statement:
                    case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
                        statement.lineno == statement.end_lineno and not _is_none(value)
                    ):
                        self._bind(number, block, name, statement.lineno)
                    case ast.For(target=ast.Name(id=name)) if statement.iter.end_lineno == statement.lineno:
                        self._bind(number, block, name, statement.lineno)
                    case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                        inner = statement.lineno
                    case _:
                        pass
                for name in ("body", "orelse", "finalbody"):
                    if nested := getattr(statement, name, None):
                        queue.append((nested, inner, block))
                if isinstance(statement, ast.Try):
                    queue += [(handler.body, inner, block) for handler in statement.handlers]

    def _bind(self, scope: int, block: int, name: str, line: int) -> None:
        self._bound[scope, name].append((line, block, self._lines[line - 1]))

    def _lines_of_editors(self) -> Iterator[int]:
        """The lines that read a member of the context that only some editors provide."""
        for node, resolution in self._analysis.resolutions.items():
            if isinstance(node, ast.Attribute) and any(map(self._is_of_editors, resolution.symbols)):
                yield node.lineno

    def editor_cost(self, statement: ast.stmt) -> float:
        """What is added to the cost of a statement for the members of the context that a script does not have."""
        return _OF_EDITORS if statement.lineno in self._editor_lines else 0.0

    def examples(self, rows: list[tuple[float, ast.stmt]]) -> list[Example]:
        """The clearest of a symbol's uses: (cost of the way it is used, statement)."""
        found: list[Example] = []
        # The text of a statement is looked at for the likeliest ones only.
        for step, statement in sorted(rows, key=lambda row: row[0])[: 3 * MOST_EXAMPLES]:
            if statement not in self._texts:
                self._texts[statement] = self._text(statement)
            text = self._texts[statement]
            if text is not None:
                cost, line, code = text
                found.append(Example(round(step + cost + self._cost, 2), self._file, line, code))
        return clearest(found)

    def _text(self, statement: ast.stmt) -> tuple[float, int, str] | None:
        """(cost, line, code) of a statement, with the binding of the name that it begins with."""
        if isinstance(statement, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            return self._definition_text(statement)
        code = self._quoted(statement)
        if code is None:
            return None
        names = [node for node in _names(statement) if node.id not in _BUILTINS]
        first = statement.lineno
        unknown, of_editors = 0, False
        layouts = {node.id for node in names if self._analysis.types.get(node) == _LAYOUT}
        bound: list[tuple[int, str, str]] = []
        for name in dict.fromkeys(node.id for node in names if isinstance(node.ctx, ast.Load)):
            if name in layouts:
                continue  # everyone knows what a layout is
            if (line := self._binding(statement, name)) is not None:
                bound.append((*line, name))
            elif any(self._analysis.types.get(n, UNKNOWN) is UNKNOWN for n in names if n.id == name):
                unknown += 1
            else:
                unknown += 0.4
        # The nearest first: what a loop binds may be used by what is bound in it.
        left_out = 0
        for number, line, name in sorted(bound, reverse=True):
            steps = self._steps_between(statement, name, number)
            free = _MOST_LINES - 1 - code.count("\n")
            if free <= len(steps):
                left_out += len(steps)
                steps = []
            if free and line not in code:
                shown = "\n".join([*(step for step in steps if step not in code), code])
                code = f"{line}\n{_indented(shown) if line.startswith('for ') else shown}"
                first = min(first, number)
                of_editors |= number in self._editor_lines
        is_preset = self._file.startswith(PRESETS)
        if (is_preset and any(map(self._is_of_editors, _OF_CONTEXT.findall(code)))) or not _is_code(code):
            return None
        cost = 1.2 * unknown + len(code) / 60 + 0.3 * code.count("\n") + _STEP_LEFT_OUT * left_out
        cost += 1.0 if "self." in code else 0.0
        cost += 1.5 if isinstance(statement, (ast.If, ast.While, ast.Return)) else 0.0
        if isinstance(statement, ast.Assign) and _is_literal(statement.value):
            cost += 2.0 if _is_none(statement.value) else -1.0  # it does not show what is taken
        return cost + (_OF_EDITORS if of_editors else 0.0), first, code

    def _definition_text(
        self, definition: ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    ) -> tuple[float, int, str] | None:
        is_class = isinstance(definition, ast.ClassDef)
        code = derived_class(definition, self._lines) if is_class else decorated_function(definition)
        if code is None:
            return None
        bases = definition.bases if is_class else ()
        is_alone = all(isinstance(self._analysis.types.get(base), ClassObject) for base in bases)
        return len(code) / 300 + (0.0 if is_alone else _OWN_BASE), definition.lineno, code

    def _is_of_editors(self, member: str) -> bool:
        """Whether only some editors provide a member of the context: a preset is run from a panel of such a one."""
        if not member.startswith(_CONTEXTS):
            return False
        symbol = self._api.symbols.symbol(member)
        return symbol is not None and bool(symbol.editors) and "screen" not in symbol.editors

    def _quoted(self, statement: ast.stmt) -> str | None:
        """A statement's own lines, or its first ones up to its body; one line where it is written in many."""
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Try)):
            return None
        body = getattr(statement, "body", None)
        last = body[0].lineno - 1 if body else statement.end_lineno or statement.lineno
        if last < statement.lineno:
            return None
        lines = self._lines[statement.lineno - 1 : last]
        while body and lines and (not lines[-1].strip() or lines[-1].lstrip().startswith("#")):
            lines.pop()
        if len(lines) <= _MOST_LINES and all(len(line.strip()) <= _LONGEST_LINE for line in lines):
            # What a call returns is to be returned: ``return context.window_manager.invoke_popup(self)``.
            is_value = isinstance(statement, ast.Return) and not isinstance(statement.value, ast.Call)
            return _alone(_dedented(lines), has_body=bool(body), is_value=is_value)
        if body or len(lines) > 4 * _MOST_LINES:
            return None
        text = ast.unparse(statement)
        return text if len(text) <= _LONGEST_REWRITTEN and "\n" not in text else None

    def _binding(self, statement: ast.stmt, name: str) -> tuple[int, str] | None:
        """(line, text) of the nearest binding of a name above a statement, in the same function.

        None where that stands in another branch, which a run may not come through.
        """
        rows = self._bound.get((self._scope_of.get(statement, -1), name), ())
        near = [row for row in rows if statement.lineno - _NEAR <= row[0] < statement.lineno]
        line, block, text = max(near, default=(0, -1, ""))
        if block not in self._blocks(statement) or len(text.strip()) > _LONGEST_LINE:
            return None
        return line, without_comment(text)

    def _steps_between(self, statement: ast.stmt, name: str, bound: int) -> list[str]:
        """What is done to a name's thing between the line where it is bound and a statement, in the same block.

        Without it the statement may fail: ``strip.keyframe_points.add(2)`` before the first of them is set.
        """
        return [
            without_comment(self._lines[step.lineno - 1])
            for step in self._statements[self._block_of.get(statement, -1)]
            if bound < step.lineno < statement.lineno
            and step.lineno == step.end_lineno
            and len(self._lines[step.lineno - 1].strip()) <= _LONGEST_LINE
            and _changes(step, name)
        ]

    def _blocks(self, statement: ast.stmt) -> Iterator[int]:
        """The blocks that a statement stands in, innermost first."""
        block = self._block_of.get(statement, -1)
        while block >= 0:
            yield block
            block = self._around[block]


def _names(statement: ast.stmt) -> Iterator[ast.Name]:
    """The names in a statement, without those in the statements below it."""
    queue: list[ast.AST] = [statement]
    while queue:
        node = queue.pop()
        if isinstance(node, ast.Name):
            yield node
        queue += [child for child in children(node) if not isinstance(child, ast.stmt)]


def _changes(statement: ast.stmt, name: str) -> bool:
    """Whether a statement sets something of a name's thing, calls something of it, or fills it."""
    match statement:
        case ast.Assign(targets=[(ast.Attribute() | ast.Subscript()) as target]):
            return _root(target) == name
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="foreach_get"), args=[_, ast.Name(id=filled)])):
            return filled == name
        case ast.Expr(value=ast.Call(func=ast.Attribute() as called)):
            return _root(called) == name
        case _:
            return False


def _root(node: ast.expr) -> str:
    """The name that an expression begins with; empty for none."""
    while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call)):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else ""


def _is_literal(node: ast.expr) -> bool:
    if isinstance(node, (ast.Tuple, ast.List, ast.Set)):
        return all(_is_literal(item) for item in node.elts)
    return isinstance(node, ast.Constant) or (isinstance(node, ast.UnaryOp) and _is_literal(node.operand))


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _is_code(code: str) -> bool:
    """Whether Python can read some code by itself."""
    try:
        ast.parse(code)
    except (SyntaxError, ValueError):
        return False
    return True


def _alone(code: str, *, has_body: bool, is_value: bool) -> str:
    """The lines of a statement as code that Python can read without what stands above and below them."""
    code = code.removeprefix("return " if is_value else "").removeprefix("el" if code[:5] == "elif " else "")
    return f"{code}\n    ..." if has_body else code


def _dedented(lines: list[str]) -> str:
    margin = len(lines[0]) - len(lines[0].lstrip())
    return "\n".join(line[min(margin, len(line) - len(line.lstrip())) :].rstrip() for line in lines)


def _indented(code: str) -> str:
    return "\n".join(f"    {line}" for line in code.split("\n"))
