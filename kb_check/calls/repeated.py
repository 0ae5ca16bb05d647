"""Whether two calls are surely made one after the other, on one thing that is as the first has left it."""

from __future__ import annotations

import ast
from bisect import bisect_left
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.modes.keeping import is_harmless, own_names
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.bodies import places
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_check.script import Script

_REMOVING = frozenset({"remove", "clear", "read_homefile", "open_mainfile", "read_factory_settings"})


@dataclass(frozen=True, slots=True)
class _Body:
    """Places in a body of statements, in order: of what may remove things, of what may make another object the active
    one, and by name of what binds one.
    """

    removing: list[int] = field(default_factory=list[int])
    activating: list[int] = field(default_factory=list[int])
    binding: defaultdict[str, list[int]] = field(default_factory=lambda: defaultdict[str, list[int]](list))


def follows(script: Script, before: ast.Call, call: ast.Call, owner: ast.expr) -> bool:
    """Whether a call is surely made on the same thing, ``owner``, as one before, and nothing is removed."""
    root = owner
    while isinstance(root, (ast.Attribute, ast.Subscript)):
        root = root.value
    first, second = _statements(script).get(before), _statements(script).get(call)
    if not isinstance(root, ast.Name) or first is None or second is None:
        return False
    (body, start), (other, end) = places(script)[first], places(script)[second]
    if body is not other:
        return False
    held = _body(script, body[0])
    # What is read from the context is that of the object which is active at the time.
    changing = held.binding.get(root.id, ()) if root.id in bindings(script) else held.activating
    return not _is_between(held.removing, start, end) and not _is_between(changing, start, end)


@once_per_script
def _statements(script: Script) -> dict[ast.expr, ast.stmt]:
    """Value → the statement that is nothing else, or that assigns it."""
    return {node.value: node for node in script.all(ast.Expr, ast.Assign) if node in places(script)}


@once_for_each
def _body(script: Script, first: ast.stmt) -> _Body:
    """The places in the body that begins with a statement."""
    statements, _ = places(script)[first]
    body, removing = _Body(), _removing(script)
    for place, statement in enumerate(statements):
        for node in walk(statement):
            match node:
                case ast.Attribute(attr=name) if name in removing:
                    body.removing.append(place)
                case ast.Attribute(attr="active", ctx=ast.Store()) | ast.Attribute(attr="select_set"):
                    body.activating.append(place)
                case ast.Call() if not is_harmless(script, node):
                    body.activating.append(place)
                case ast.Name(id=name):
                    if name in removing:
                        body.removing.append(place)
                    if isinstance(node.ctx, ast.Store):
                        body.binding[name].append(place)
                case _:
                    pass
    return body


@once_per_script
def _removing(script: Script) -> frozenset[str]:
    """The names of what may remove things: the script's own functions too, where it removes any."""
    return _REMOVING | own_names(script) if named_words(script) & _REMOVING else _REMOVING


def _is_between(places_of: Sequence[int], start: int, end: int) -> bool:
    at = bisect_left(places_of, start)
    return at < len(places_of) and places_of[at] < end
