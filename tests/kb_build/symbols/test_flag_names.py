"""Flags of symbols are told by the names that flag_names.py gives them: a misspelt text would be a silent no."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_build.symbols import flag_names
from kb_build.symbols.records import Symbol

if TYPE_CHECKING:
    from collections.abc import Iterator


def bare_flags(code: str) -> Iterator[int]:
    """The lines in which a text is looked for in flags."""
    for node in ast.walk(ast.parse(code)):
        match node:
            case ast.Compare(
                left=ast.Constant(value=str()),
                ops=[ast.In() | ast.NotIn()],
                comparators=[ast.Attribute(attr="flags")],
            ):
                yield node.lineno
            case ast.Call(func=ast.Attribute(attr="flagged"), args=[ast.Constant(value=str())]):
                yield node.lineno
            case _:
                pass


@pytest.mark.parametrize(
    ("code", "is_bare"),
    [
        ("'readonly' in symbol.flags", True),
        ("'readonly' not in self.symbol.flags", True),
        ("symbol.flagged('from:')", True),
        ("READ_ONLY in symbol.flags", False),
        ("symbol.flagged(PROVIDED_BY)", False),
        ("'a' in symbol.names", False),
    ],
)
def test_a_bare_flag_is_seen(code: str, is_bare: bool) -> None:
    assert bool(list(bare_flags(code))) is is_bare


@pytest.mark.parametrize("part", ["kb_build", "kb_check", "kb_serve", "measurements"])
def test_every_flag_has_a_name(part: str) -> None:
    bare = [
        f"{path.relative_to(REPO)}:{line}"
        for path in sorted((REPO / part).rglob("*.py"))
        if "inside" not in path.parts
        for line in bare_flags(path.read_text("utf-8"))
    ]
    assert not bare, f"name these flags in {flag_names.__name__}: {', '.join(bare)}"


def test_a_sockets_flags_are_read_by_their_names() -> None:
    flags = ("identifier:A_Color", "also-named:B", "type-by:data_type")
    socket = Symbol("N.inputs[A]", "socket", label="A", flags=flags)
    assert (socket.identifier, socket.socket_names, socket.type_settings) == (
        "A_Color",
        ("A", "B"),
        ("data_type",),
    )
    member = Symbol(
        "bpy.context.object", "context", flags=("same-as:bpy.types.Context.object", "from:screen")
    )
    assert (member.same_as, member.editors) == ("bpy.types.Context.object", ("screen",))
