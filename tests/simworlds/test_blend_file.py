"""What a .blend begins with."""

from __future__ import annotations

import gzip

import pytest

from simworlds.formats.blend_file import HEAD, begins_blend


@pytest.mark.parametrize(
    ("data", "may_be"),
    [
        (b"BLENDER-v501", True),
        (b"BLENDER17-01v0501", True),
        (b"\x28\xb5\x2f\xfd\x00\x00\x00\x00", True),
        (gzip.compress(b"BLENDER-v279", mtime=0), True),
        (b"BLEND", False),
        (b"", False),
        (b"import bpy", False),
    ],
)
def test_the_first_bytes_tell_a_blend(data: bytes, may_be: bool) -> None:
    assert begins_blend(data[:HEAD]) is may_be
