"""Frames whose notes cannot be read are rendered again; nothing ends over them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from agents.blender.render.frame_cache import NOTES, FrameCache, RenderedFrame

if TYPE_CHECKING:
    from pathlib import Path

PNG = b"\x89PNG" + b"IEND\xaeB`\x82"


def test_frames_are_kept_while_they_are_made_of_the_same(tmp_path: Path) -> None:
    frame = RenderedFrame(16, 0.5, len(PNG))
    cache = FrameCache(tmp_path, {"Scene S": "a"}, {"samples": 16})
    cache.path(1).write_bytes(PNG)
    cache.add(1, frame)
    assert FrameCache(tmp_path, {"Scene S": "a"}, {"samples": 16}).get(1) == frame
    assert FrameCache(tmp_path, {"Scene S": "b"}, {"samples": 16}).why == "Scene S changed"


@pytest.mark.parametrize(
    "notes",
    [
        *(
            json.dumps({"frames": {}, "settings": {}, "scene": {}, part: [1]})
            for part in ("frames", "settings", "scene")
        ),
        "[" * 200_000,
        "[]",
        "no JSON",
    ],
    ids=["frames", "settings", "scene", "deep", "list", "text"],
)
def test_notes_of_another_shape_count_as_none(tmp_path: Path, notes: str) -> None:
    (tmp_path / NOTES).write_text(notes)
    (tmp_path / "0001.png").write_bytes(PNG)
    cache = FrameCache(tmp_path, {}, {})
    assert (cache.removed, cache.why) == (1, "it is not recorded what they were made of")
