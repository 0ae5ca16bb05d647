"""Paths are taken apart and put together again without loss: all that a base has, and hard ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.symbols.paths import (
    argument_of,
    is_socket,
    item_of,
    joined_path,
    last_name,
    plain_path,
    socket_name,
    socket_node,
    socket_side,
    split_path,
)

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_N = "bpy.types.N"


def test_every_path_of_a_base_is_put_together_again(kb: KnowledgeBase) -> None:
    rows = kb.reader.rows
    paths = {path for (path,) in rows("SELECT path FROM symbols UNION SELECT path FROM removed")}
    paths |= {path for (path,) in rows("SELECT target FROM successors WHERE target != ''")}
    items = rows("SELECT owner, identifier FROM enum_items")
    paths |= {f"{owner}:{identifier}" for owner, identifier in items}
    assert {mark for _, mark, _ in map(split_path, paths)} == set(".(:<>")
    for path in paths:
        above, mark, name = split_path(path)
        assert path in {joined_path(above, mark, name), name}, path
        assert path.startswith(plain_path(path)), path
        assert (mark == ":") == bool(item_of(path)), path


def test_items_are_told_from_what_has_them(kb: KnowledgeBase) -> None:
    known = {path for (path,) in kb.reader.rows("SELECT path FROM symbols")}
    for owner, identifier in kb.reader.rows("SELECT owner, identifier FROM enum_items"):
        path = f"{owner}:{identifier}"
        whole, argument = plain_path(path), argument_of(path)
        assert whole in known, path
        assert owner == (joined_path(whole, "(", argument) if argument else whole), path
        assert item_of(path) == identifier


def test_sockets_are_told_from_their_nodes(kb: KnowledgeBase) -> None:
    sockets = kb.reader.rows("SELECT path, owner, name FROM symbols WHERE kind = 'socket'")
    assert sockets
    for path, owner, name in sockets:
        assert is_socket(path)
        assert path == f'{socket_node(path)}.{socket_side(path)}["{socket_name(path)}"]'
        assert socket_node(path) == owner
        assert socket_name(path) == name
        end = path.removeprefix(f"{owner}.")
        assert (socket_side(end), socket_name(end)) == (socket_side(path), name)


@pytest.mark.parametrize(
    ("path", "plain", "argument", "item", "socket"),
    [
        (f"{_N}.type", f"{_N}.type", "", "", ("", "", "")),
        (f"{_N}.type:A", f"{_N}.type", "", "A", ("", "", "")),
        ("bpy.ops.a.b(c)", "bpy.ops.a.b", "c", "", ("", "", "")),
        ("bpy.ops.a.b(c):D", "bpy.ops.a.b", "c", "D", ("", "", "")),
        (f'{_N}.inputs["A:B (c).d"]', f'{_N}.inputs["A:B (c).d"]', "", "", (_N, "inputs", "A:B (c).d")),
        (f'{_N}.outputs["A (c)"]:D', f'{_N}.outputs["A (c)"]', "", "D", (_N, "outputs", "A (c)")),
        ("bpy", "bpy", "", "", ("", "", "")),
    ],
)
def test_hard_paths_are_taken_apart(
    path: str, plain: str, argument: str, item: str, socket: tuple[str, str, str]
) -> None:
    assert (plain_path(path), argument_of(path), item_of(path)) == (plain, argument, item)
    assert (socket_node(path), socket_side(path), socket_name(path)) == socket


def test_the_last_name_is_behind_the_last_dot() -> None:
    assert (last_name("bpy.types.Object"), last_name("bpy")) == ("Object", "bpy")
