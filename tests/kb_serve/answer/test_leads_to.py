"""What an answer about a pointer says of what that leads to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.ways.leads_to import leads_to

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


def told(kb: KnowledgeBase, path: str) -> str:
    symbol = kb.symbol(f"bpy.types.{path}")
    assert symbol is not None
    return "\n".join(block.text for block in leads_to(symbol, kb.reader))


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("ParticleSettings.effector_weights", "**Leads to** `EffectorWeights`: `gravity` = 1"),
        ("Scene.eevee", "`taa_render_samples` = 64"),
        ("World.node_tree", "`.nodes`, `.links`"),  # which it inherits
        ("Object.parent", "`.data`"),
    ],
)
def test_the_heaviest_members_of_what_it_leads_to_are_named(path: str, said: str, kb: KnowledgeBase) -> None:
    assert said in told(kb, path)
    assert said in kb.query(path).text


def test_nothing_is_said_of_any_data_block(kb: KnowledgeBase) -> None:
    assert told(kb, "Object.data") == ""


@pytest.mark.blender
def test_what_is_named_is_there(kb: KnowledgeBase) -> None:
    bpy = pytest.importorskip("bpy")
    import re

    weights = bpy.data.particles.new("p").effector_weights
    names = re.findall(r"`\.?(\w+)(?:\(\))?`", told(kb, "ParticleSettings.effector_weights"))[1:]
    assert names
    assert all(hasattr(weights, name) for name in names)
