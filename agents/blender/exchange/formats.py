"""The formats of other programs: their endings, and what a file of each can keep."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class Format:
    """A format. ``folders``: endings whose export is several files, in a folder of their own.

    The rest is what the format keeps. ``whole``: objects stay apart; a file without it is one mesh.
    """

    kind: str
    label: str
    endings: tuple[str, ...]
    folders: tuple[str, ...] = ()
    materials: bool = True
    textures: bool = True
    hierarchy: bool = True
    motion: bool = True
    uv_maps: bool = True
    whole: bool = True
    units: str = "in metres"


_SAYS = "its unit is written in it"
FORMATS = (
    Format("gltf", "glTF", (".glb", ".gltf"), (".gltf",)),
    Format("usd", "USD", (".usdz", ".usdc", ".usda", ".usd"), (".usdc", ".usda", ".usd"), units=_SAYS),
    Format("fbx", "FBX", (".fbx",), units=_SAYS),
    Format("obj", "OBJ", (".obj",), (".obj",), hierarchy=False, motion=False, units="without a unit"),
    Format("abc", "Alembic", (".abc",), textures=False, units="without a unit"),
    Format(
        "stl", "STL", (".stl",), materials=False, textures=False, hierarchy=False, motion=False, uv_maps=False,
        whole=False, units="without a unit",
    ),
)  # fmt: skip
_BY_ENDING = {ending: known for known in FORMATS for ending in known.endings}
ENDINGS = tuple(_BY_ENDING)


def format_of(name: str) -> Format:
    """The format of a file by its name's ending. Raises Refusal."""
    ending = PurePosixPath(name).suffix.lower()
    if (known := _BY_ENDING.get(ending)) is None:
        raise Refusal(
            f"{name[:120]!r} has no ending of a known format; known are {', '.join(ENDINGS)}. "
            "blender_load opens .blend files."
        )
    return known


def describe_support(version: str, supported: Mapping[str, Mapping[str, bool]]) -> str:
    """What a Blender reads and writes, and what its build lacks, in lines."""
    lines = [f"Blender {version} reads and writes:"]
    for known in FORMATS:
        does = supported.get(known.kind, {})
        lacks = [word for verb, word in (("reads", "reading"), ("writes", "writing")) if not does.get(verb)]
        note = f": **this build lacks {' and '.join(lacks)}**" if lacks else ""
        lines.append(f"- {known.label} ({', '.join(known.endings)}), {known.units}{note}")
    return "\n".join(lines)
