"""What a mesh is made of, where it is none: vertices without three coordinates, edges and faces of missing ones.

```python
mesh.from_pydata([(0, 0), (1, 0), (1, 1)], [], [(0, 1, 2)])  # reported: three numbers each
mesh.from_pydata([(x, y) for x, y in points], [], [])  # reported
mesh.from_pydata(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0)], [], [(1, 2, 3)]
)  # reported, as a warning: they count from 0
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [], [(0, 1, 2)])
```

Too few numbers are an error. With too many, each vertex gets numbers of the one before; a number that no vertex has
makes an invalid mesh, which may crash Blender, and of which ``mesh.validate()`` leaves nothing: these are warnings, the
first one of each list. Not reported: lists that are not written out, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.syntax.literals import lists_left_alone, number, written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_PATH = f"{T}Mesh.from_pydata"
_CORNERS = 3  # of a face, at least


class _Kind(NamedTuple):
    argument: str
    one: str
    wanted: int


_VERTICES, _EDGES, _FACES = _Kind("vertices", "vertex", 3), _Kind("edges", "edge", 2), "faces"
_WORDS = {2: "two", 3: "three"}


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        if call.callee.symbol.path != _PATH or is_tried(script, call.node):
            continue
        for kind in (_VERTICES, _EDGES):
            rows, is_all = _rows(script, call.argument(kind.argument))
            yield from _wrong_rows(script, kind, rows, is_all=is_all)
        vertices, is_all = _rows(script, call.argument(_VERTICES.argument))
        if is_all:
            for argument in (_EDGES.argument, _FACES):
                rows, _ = _rows(script, call.argument(argument))
                yield from _missing(script, rows, len(vertices))
        faces, _ = _rows(script, call.argument(_FACES))
        if small := next((face for face in faces if len(face.elts) < _CORNERS), None):
            told = f"A face has three vertices or more: this makes an invalid mesh. Edges are for {_EDGES.argument!r}."
            yield Finding(RULE.id, "warning", script.span(small), told, _PATH)


def _rows(script: Script, node: ast.expr | None) -> tuple[list[ast.Tuple | ast.List], bool]:
    """The rows of a list that are written out, and whether these are all of it."""
    if isinstance(node, ast.Name):
        node = lists_left_alone(script).get(node.id) or written(script, node)
    match node:
        case ast.List(elts=items) | ast.Tuple(elts=items):
            pass
        case ast.ListComp(elt=item):
            items = [item]
        case _:
            return [], False
    rows = [item for item in items if isinstance(item, (ast.Tuple, ast.List))]
    rows = [row for row in rows if not any(isinstance(part, ast.Starred) for part in row.elts)]
    return rows, bool(items) and len(rows) == len(items) and not isinstance(node, ast.ListComp)


def _wrong_rows(
    script: Script, kind: _Kind, rows: list[ast.Tuple | ast.List], *, is_all: bool
) -> Iterator[Finding]:
    wrong = next((row for row in rows if len(row.elts) != kind.wanted), None)
    if wrong is None:
        return
    given, wanted = sum(len(row.elts) for row in rows), kind.wanted * len(rows)
    is_comprehension = not is_all and len(rows) == 1
    is_refused = (is_all or is_comprehension) and (given < wanted or (kind is _EDGES and given != wanted))
    told = f"Each {kind.one} has {_WORDS[kind.wanted]} numbers, this one {len(wrong.elts)}: "
    told += "RuntimeError." if is_refused else "the others get what is not theirs."
    yield Finding(RULE.id, "error" if is_refused else "warning", script.span(wrong), told, _PATH)


def _missing(script: Script, rows: list[ast.Tuple | ast.List], count: int) -> Iterator[Finding]:
    """The first index of a list that no vertex has."""
    for node in (part for row in rows for part in row.elts):
        index = number(script, node)
        if isinstance(index, int) and not 0 <= index < count:
            told = f"There is no vertex {index} among {count}, counted from 0: this makes an invalid mesh."
            yield Finding(RULE.id, "warning", script.span(node), told, _PATH)
            return


RULE = Rule("wrong-mesh-data", "error", "Vertices, edges and faces that are no mesh", _check)
