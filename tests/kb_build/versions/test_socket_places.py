"""Where the sockets of several Blenders stand, in a file, and which of them have moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.errors import StoreError
from kb_build.symbols.records import Symbol
from kb_build.versions.moved_sockets import find_moved_sockets
from kb_build.versions.socket_places import SocketPlaces, places_of

if TYPE_CHECKING:
    from pathlib import Path

_NODE = "bpy.types.N"


def _sockets(*names: str) -> list[Symbol]:
    return [
        Symbol(
            path=f'{_NODE}.inputs["{name}"]',
            kind="socket",
            owner=_NODE,
            label=name,
            subscripts=(f"inputs[{at}]",),
        )
        for at, name in enumerate(names)
    ]


def _places(*names: str) -> dict[tuple[str, str], list[str]]:
    return {(_NODE, "inputs"): list(names)}


def _moved(
    before: tuple[str, ...], now: tuple[str, ...], renamed: tuple[str, str] | None = None
) -> list[str]:
    places = SocketPlaces({"4.2.1": _places(*before), "5.1.0": _places(*now)})
    old, new = renamed or ("", "")
    rows = [(f'{_NODE}.inputs["{old}"]', 0, f'{_NODE}.inputs["{new}"]', "", "5.0", "")] if renamed else []
    return [
        f"{path} {version} {name}"
        for path, version, name in find_moved_sockets(_sockets(*now), places, "5.1", rows)
    ]


def test_what_stands_behind_a_new_socket_has_moved() -> None:
    found = _moved(("Color", "Roughness", "IOR"), ("Color", "Metallic", "Roughness", "IOR"))
    assert found == [f"{_NODE}.inputs[1] 4.2 Roughness", f"{_NODE}.inputs[2] 4.2 IOR"]


def test_what_is_only_called_otherwise_has_not() -> None:
    assert _moved(("Fac", "Color"), ("Factor", "Color")) == []
    assert _moved(("Fac", "Color"), ("Factor", "Color"), ("Fac", "Factor")) == []
    # It went elsewhere, under another name.
    assert _moved(("Fac", "Color"), ("Size", "Color", "Factor"), ("Fac", "Factor")) == [
        f"{_NODE}.inputs[0] 4.2 Fac"
    ]


def test_newer_versions_and_lacking_places_tell_nothing() -> None:
    places = SocketPlaces({"4.2.1": _places("Color"), "5.2.0": _places("IOR", "Color")})
    assert list(find_moved_sockets(_sockets("Color", "IOR"), places, "5.1", [])) == []


def test_the_file_has_what_differs(tmp_path: Path) -> None:
    same = {("bpy.types.Same", "outputs"): ["Value"]}
    places = SocketPlaces(
        {"4.2.1": {**_places("A, b", ""), **same}, "5.1.0": {**_places("New", "A, b", "C"), **same}}
    )
    file = tmp_path / "places.csv"
    file.write_text(places.to_text(), encoding="utf-8")
    again = SocketPlaces.load(file)
    assert again.names("5.1", _NODE, "inputs") == ["New", "A, b", "C"]
    assert again.names("4.2", _NODE, "inputs") == ["A, b", "", ""]
    assert again.names("4.2", "bpy.types.Same", "outputs") is None
    assert again.before("5.1") == ("4.2",)
    assert again.to_text() == places.to_text()


@pytest.mark.parametrize("text", ["", "node,place\n", "node,side,place,4.2.1\na,b\n"])
def test_a_file_that_is_none_is_told(text: str, tmp_path: Path) -> None:
    file = tmp_path / "places.csv"
    file.write_text(text)
    with pytest.raises(StoreError, match="simworlds kb history"):
        SocketPlaces.load(file)


def test_the_shipped_file_has_what_blender_moved() -> None:
    places = SocketPlaces.load()
    names = places.names("3.4", "bpy.types.ShaderNodeBsdfPrincipled", "inputs")
    assert names is not None
    assert names[9] == "Roughness"


def test_sockets_are_found_by_their_places() -> None:
    assert places_of(_sockets("A", "B")) == _places("A", "B")
