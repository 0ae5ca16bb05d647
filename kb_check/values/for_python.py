"""What Python refuses of Blender's values: floats where it wants a whole number (in ``range``, as an index, as how
often a text is repeated), and what ``json`` is given that is no plain value.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Instance, Plain, Sequence, Tuple, members
from kb_check.calls.resolved import builtin_called
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_REFUSES = ("TypeError",)


def floats_for_ints(script: Script) -> Iterator[tuple[ast.expr, str]]:
    """What surely is a float, and what wants an int in its place, in words."""
    for node, wanting in (*_of_ranges(script), *_indices(script), *_repeated(script)):
        if _kinds(script, node) == {"float"} and not is_tried(script, node, _REFUSES):
            yield node, wanting


def not_for_json(script: Script) -> Iterator[tuple[ast.expr, str]]:
    """What ``json.dumps`` surely refuses of what it is given, and its class, where no function converts it."""
    for call in script.all(ast.Call):
        match call:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="json"), attr="dump" | "dumps"), args=[given, *_]
            ):
                names = {keyword.arg for keyword in call.keywords}
            case _:
                continue
        if names.isdisjoint({"default", "cls", None}) and not is_tried(script, call, _REFUSES):
            yield from _instances(script, given)


def _instances(script: Script, node: ast.expr) -> Iterator[tuple[ast.expr, str]]:
    """The parts of a literal, or the whole, that surely are instances of classes of the API."""
    match node:
        case ast.Dict(values=parts) | ast.List(elts=parts) | ast.Tuple(elts=parts):
            for part in parts:
                yield from _instances(script, part)
        case _:
            kinds = members(script.type_of(node) or UNKNOWN)
            if all(isinstance(kind, Instance) and kind.sure for kind in kinds):
                yield node, next(kind.cls for kind in kinds if isinstance(kind, Instance))


def _of_ranges(script: Script) -> Iterator[tuple[ast.expr, str]]:
    for call in script.all(ast.Call):
        if builtin_called(script, call) == "range":
            yield from ((bound, "`range` takes") for bound in call.args)


def _indices(script: Script) -> Iterator[tuple[ast.expr, str]]:
    for node in script.all(ast.Subscript):
        if not _is_list(script.type_of(node.value)):
            continue
        part = node.slice
        bounds = (part.lower, part.upper, part.step) if isinstance(part, ast.Slice) else (part,)
        yield from ((bound, "The index of a list is") for bound in bounds if bound is not None)


def _repeated(script: Script) -> Iterator[tuple[ast.expr, str]]:
    for node in script.all(ast.BinOp):
        if not isinstance(node.op, ast.Mult):
            continue
        for one, other in ((node.left, node.right), (node.right, node.left)):
            if _kinds(script, one) == {"str"} or _is_list(script.type_of(one)):
                yield other, "How often something is repeated is"


def _is_list(kind: Type | None) -> bool:
    """Whether a value surely is a list or a tuple of Python's."""
    return all(
        isinstance(one, Tuple) or (isinstance(one, Sequence) and one.kind == "list")
        for one in members(kind or UNKNOWN)
    )


def _kinds(script: Script, node: ast.expr) -> set[str]:
    """The kinds of plain values that an expression can be, ``""`` for anything else."""
    kinds = members(script.type_of(node) or UNKNOWN)
    return {kind.kind if isinstance(kind, Plain) else "" for kind in kinds}
