"""The files that an OBJ names are found however they are written, as Blender's importer reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.inside.exchange.references import check_file
from simworlds.sandbox.inside.refusal import Refused

if TYPE_CHECKING:
    from pathlib import Path


def check(root: Path, obj: bytes = b"mtllib own.mtl\n", library: bytes = b"", name: str = "own.mtl") -> None:
    """Checks an .obj that lies in a folder of ``root``, beside a library of that name."""
    folder = root / "model"
    folder.mkdir()
    (folder / "own.obj").write_bytes(obj + b"v 0 0 0\n")
    (folder / name).write_bytes(b"newmtl plain\n" + library + b"\n")
    check_file("obj", str(folder / "own.obj"), str(root))


@pytest.mark.parametrize(
    "line",
    [
        b"mtllib ../../x.mtl",
        b"  mtllib ../../x.mtl",
        b"\tmtllib\t../../x.mtl",
        b"mtllib\x01../../x.mtl",
        b'mtllib "../../x.mtl"',
        b"mtllib /x.mtl",
    ],
)
def test_libraries_outside_are_refused(tmp_path: Path, line: bytes) -> None:
    with pytest.raises(Refused, match="names files outside"):
        check(tmp_path, line + b"\n")


@pytest.mark.parametrize(
    "line",
    [
        b"map_Kd ../../x.png",
        b"map_Kd\t../../x.png",
        b"\x01map_Kd\x02../../x.png",
        b'map_Kd "../../x.png"',
        b'map_Kd ".."/../x.png',
        b"map_Kd ..\\..\\x.png",
        b"map_Kd -bm 1 ../../my secret.png",
        b'map_Bump -s 1 1 1 -clamp on "../../my secret.png"',
        b"map_Kd -o 0 0 /x.png",
        b"refl -type sphere ../../x.png",
    ],
)
def test_images_outside_are_refused(tmp_path: Path, line: bytes) -> None:
    with pytest.raises(Refused, match="names files outside"):
        check(tmp_path, library=line)


def test_links_that_only_another_spelling_finds_are_refused(tmp_path: Path) -> None:
    """The importer also looks for an image with blanks for underscores, and without its folders."""
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "my link.png").symlink_to("/dev/null")
    (tmp_path / "model" / "link.png").symlink_to("/dev/null")
    for name in (b"my_link.png", b"nowhere/link.png", b"C:\\nowhere\\link.png"):
        (tmp_path / "model" / "own.mtl").write_bytes(b"map_Kd " + name)
        (tmp_path / "model" / "own.obj").write_bytes(b"v 0 0 0\n")
        with pytest.raises(Refused, match="names files outside"):
            check_file("obj", str(tmp_path / "model" / "own.obj"), str(tmp_path))


def test_the_library_that_is_called_as_the_file_is_read_without_being_named(tmp_path: Path) -> None:
    with pytest.raises(Refused, match="names files outside"):
        check(tmp_path, b"", b"map_Kd ../../x.png")


def test_images_are_looked_for_beside_their_library(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "own.obj").write_bytes(b"mtllib ../up.mtl\n")
    (tmp_path / "up.mtl").write_bytes(b"map_Kd own.png\n")
    check_file("obj", str(tmp_path / "model" / "own.obj"), str(tmp_path))
    (tmp_path / "up.mtl").write_bytes(b"map_Kd ../x.png\n")
    with pytest.raises(Refused, match="names files outside"):
        check_file("obj", str(tmp_path / "model" / "own.obj"), str(tmp_path))


@pytest.mark.parametrize(
    ("obj", "library", "why"),
    [
        (b"mtllib \\\n../../x.mtl\n", b"", "goes on in another line"),
        (b"".join(b"mtllib %d.mtl\n" % number for number in range(101)), b"", "more than 100"),
        (b"", b"#" * 21_000_000, "has 21 MB"),
        (b"", b"map_Kd -s" + b" 1" * 10_000, "20,002 letters"),
    ],
)
def test_what_cannot_be_looked_through_is_refused(
    tmp_path: Path, obj: bytes, library: bytes, why: str
) -> None:
    with pytest.raises(Refused, match=why):
        check(tmp_path, obj, library)


def test_honest_names_pass(tmp_path: Path) -> None:
    images = (
        b"map_Kd my textures/wood.png",
        b"map_Ks -s 1 1 1 ../shared/wood.png",
        b"map_Bump C:\\Users\\me\\wood.png",
        b"bump -bm 0.5 wood_grain.png",
        b"Kd 1 1 1 ../../x.png",
    )
    check(tmp_path, b"# by hand\nmtllib own.mtl\n", b"\n".join(images))
