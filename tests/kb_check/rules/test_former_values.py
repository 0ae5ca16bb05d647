"""The value that a former name is given: what it is for the new one, where that wants another."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_check.checker import Checker

_TREE = "import bpy\ntree = bpy.data.node_groups.new('C', 'CompositorNodeTree')\n"
_GLARE = _TREE + "node = tree.nodes.new('CompositorNodeGlare')\n"
_BALANCE = _TREE + "node = tree.nodes.new('CompositorNodeColorBalance')\n"
_EXPORT = "import bpy\nbpy.ops.export_scene.gltf(filepath='a.glb', {})"


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (f"{_GLARE}node.quality = 'HIGH'", "'HIGH' is 'High' there."),
        (f"{_GLARE}node.glare_type = 'FOG_GLOW'", "'FOG_GLOW' is 'Fog Glow' there."),
        (f"kind = 'GHOSTS'\n{_GLARE}node.glare_type = kind", "'GHOSTS' is 'Ghosts' there."),
        (f"{_BALANCE}node.lift = (0.95, 0.98, 1.05)", "It takes 4 numbers, with alpha."),
        (_EXPORT.format("export_colors=True"), "It takes 'MATERIAL', 'ACTIVE', 'NAME', 'NONE'."),
    ],
)
def test_another_value_is_told(checker: Checker, code: str, told: str) -> None:
    (finding,) = checker.check(code)
    assert finding.message.endswith(f" {told}")


@pytest.mark.parametrize(
    "code",
    [
        f"{_GLARE}node.threshold = 0.5",
        f"{_BALANCE}node.lift = (0.95, 0.98, 1.05, 1.0)",
        f"{_GLARE}node.quality = pick()",
        _EXPORT.format("export_colors='MATERIAL'"),
    ],
)
def test_nothing_is_told_of_a_value_that_may_stay(checker: Checker, code: str) -> None:
    messages = [finding.message for finding in checker.check(code)]
    assert [text for text in messages if " there." in text or "It takes" in text] == []
    assert messages
