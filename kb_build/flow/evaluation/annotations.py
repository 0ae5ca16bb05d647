"""What annotations in a script mean."""

from __future__ import annotations

import ast

from kb_build.flow.state.core import DEEPEST, Core
from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import (
    BOOL,
    FLOAT,
    INT,
    NONE,
    STR,
    UNKNOWN,
    Mapping,
    Plain,
    Sequence,
    Tuple,
    Type,
    instance_of,
    union,
)

_PLAIN: dict[str, Type] = {
    "str": STR, "int": INT, "bool": BOOL, "bytes": Plain("bytes"), "None": NONE,
    "float": union((FLOAT, INT)),  # as for type checkers
}  # fmt: skip
_LISTS = {
    "list": "list", "List": "list", "Sequence": "list", "set": "set", "Set": "set", "frozenset": "set",
    "Iterable": "iterator", "Iterator": "iterator", "Collection": "list",
}  # fmt: skip
_DEEPEST = 20
_LONGEST = 10_000  # characters of a quoted annotation
_QUOTES = frozenset({1, 3})


class Annotations(Core):
    """Reads annotations."""

    def annotated(self, node: ast.expr) -> Type:
        """The type of a value with this annotation; a wrong name in it is no error where Python does not read it."""
        if not self.here.file.keeps_annotations:
            return self._meant(node)
        with self.ready_for():
            return self._meant(node)

    def _quoted(self, node: ast.Constant) -> Type:
        """What a quoted annotation means, which Python does not read."""
        if node not in self.here.file.quoted:
            self.here.file.quoted[node] = _unquoted(node)
        inner = self.here.file.quoted[node]
        if inner is None or self.here.depth > DEEPEST:
            return UNKNOWN
        with self.ready_for():
            self.here.depth += 1
            kind = self._meant(inner)
            self.here.depth -= 1
        return kind

    def _meant(self, node: ast.expr, depth: int = 0) -> Type:  # noqa: PLR0911 - one return a form
        """The same of a part, which lies so deep inside."""
        if depth > _DEEPEST:
            return UNKNOWN
        match node:
            case ast.Constant(value=None):
                return NONE
            case ast.Constant(value=str()):
                return self._quoted(node)
            case ast.BinOp(op=ast.BitOr()):
                return union(self._meant(side, depth + 1) for side in (node.left, node.right))
            case ast.Subscript():
                return self._generic(node, depth + 1)
            case ast.Name(id=name) if name in _PLAIN:
                return _PLAIN[name]
            case ast.Name(id=name) if name in _LISTS:
                return Sequence(_LISTS[name], UNKNOWN)
            case ast.Name() | ast.Attribute():
                return instance_of(self.evaluate(node))
            case _:
                self.evaluate(node)
                return UNKNOWN

    def _generic(self, node: ast.Subscript, depth: int) -> Type:  # noqa: PLR0911 - one return a form
        head = node.value
        name = head.id if isinstance(head, ast.Name) else head.attr if isinstance(head, ast.Attribute) else ""
        inside = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if not inside:
            return UNKNOWN
        if name == "Optional":
            return union((self._meant(inside[0], depth), NONE))
        if name == "Union":
            return union(self._meant(item, depth) for item in inside)
        if name in _LISTS:
            return Sequence(_LISTS[name], self._meant(inside[0], depth))
        if name in {"tuple", "Tuple"}:
            # With one item it is one by the rules, and by whoever writes it often a row of any length.
            if len(inside) == 1 or (isinstance(inside[-1], ast.Constant) and inside[-1].value is ...):
                return Sequence("tuple", self._meant(inside[0], depth))
            return Tuple(tuple(self._meant(item, depth) for item in inside))
        if name in {"dict", "Dict", "Mapping"} and len(inside) == 2:
            key, value = (self._meant(item, depth) for item in inside)
            return Mapping(key, value)
        self.evaluate(node)
        return UNKNOWN


def _unquoted(node: ast.Constant) -> ast.expr | None:
    """What a quoted annotation says, in its place in the script; None for what cannot be read.

    Where its text is not written as it is read, each part has the place of the whole.
    """
    text = node.value
    if not isinstance(text, str) or len(text) > _LONGEST:
        return None
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    quotes, odd = divmod((node.end_col_offset or 0) - node.col_offset - len(text.encode()), 2)
    is_plain = node.lineno == node.end_lineno and not odd and quotes in _QUOTES and "\\" not in text
    for part in walk(tree):
        if not is_plain:
            ast.copy_location(part, node)
        elif isinstance(part, (ast.expr, ast.keyword)):
            part.lineno = part.end_lineno = node.lineno
            part.col_offset += node.col_offset + quotes
            part.end_col_offset = (part.end_col_offset or 0) + node.col_offset + quotes
    return tree
