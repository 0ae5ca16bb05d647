"""Ways to read what is not Blender's."""

from __future__ import annotations

from way import Tool, way

_DIRECTLY = "read(target.file)"

WAYS = (
    way("open", "files", "read(target.file)"),
    way("open-a-key-in-the-home-folder", "files", "read(target.key)"),
    way("list-a-folder", "files", "os.listdir(target.names)"),
)
