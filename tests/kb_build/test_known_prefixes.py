"""Known prefixes are found as by trying each."""

from __future__ import annotations

import random

from kb_build.known_prefixes import KnownPrefixes


def test_finds_what_a_text_begins_with() -> None:
    known = KnownPrefixes(["bpy.ops.", "bpy.", "bpy.ops.mesh.", "bpy.types.a", "bpy.types.ab"])
    assert known.of("bpy.ops.mesh.delete") == ["bpy.ops.mesh.", "bpy.ops.", "bpy."]
    assert known.of("bpy.types.ab") == ["bpy.types.ab", "bpy.types.a", "bpy."]
    assert known.of("bp") == known.of("") == known.of("zzz") == []


def test_agrees_with_trying_each() -> None:
    chance = random.Random(7)

    def text() -> str:
        return "".join(chance.choice("ab.") for _ in range(chance.randrange(7)))

    for _ in range(300):
        texts = {text() for _ in range(chance.randrange(12))}
        known = KnownPrefixes(texts)
        for wanted in (text() for _ in range(20)):
            each = [one for one in texts if wanted.startswith(one)]
            assert known.of(wanted) == sorted(each, key=len, reverse=True)
