"""What a scene has one of, and a new one has not: the camera that it is rendered from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_SCENE = f"{TYPES}Scene"


def scene_parts(reader: BaseReader) -> Iterator[tuple[str, str]]:
    """The classes of object data that the scene points to an object of, each with the expression for that object."""
    for pointer in reader.members(_SCENE).values():
        cls = f"{TYPES}{pointer.name.title()}"
        is_object = pointer.type == "pointer" and f"{TYPES}{pointer.target}" == OBJECT
        if is_object and not pointer.is_read_only and reader.is_object_data(cls):
            yield cls, f"scene.{pointer.name}"
