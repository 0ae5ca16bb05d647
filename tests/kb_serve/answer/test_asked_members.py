"""The members that a question asks for one by one stand ahead of what else is told, each of them once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.asked.members import AskedMembers
from kb_serve.answer.facts.asked_values import asked_words
from kb_serve.answer.hit_lines import HitLines
from kb_serve.answer.hits import hits_of
from kb_serve.rank.ranked_id import RankedId

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


def asked(question: str, kb: KnowledgeBase, *ids: str) -> list[str]:
    found = AskedMembers(kb.reader).of(question, asked_words(question), [f"{T}{one}" for one in ids])
    return [path.removeprefix(T) for path in found]


@pytest.mark.parametrize(
    ("question", "ids", "members"),
    [
        (
            "bevel modifier segments width limit method",
            ["BevelModifier.limit_method"],
            ["BevelModifier.segments", "BevelModifier.width"],
        ),
        # One word may belong to several names, as often as it is said.
        (
            "eevee shadow ray count step count resolution scale",
            ["SceneEEVEE.use_shadows"],
            ["SceneEEVEE.shadow_ray_count", "SceneEEVEE.shadow_step_count", "SceneEEVEE.shadow_resolution_scale"],
        ),
        # By the label, by the name without what begins those of switches, by one rare word of a name.
        (
            "cloth pressure scale, fluid density",
            ["ClothSettings"],
            ["ClothSettings.pressure_factor", "ClothSettings.fluid_density", "ClothSettings.use_pressure"],
        ),
        (
            "grease pencil layer opacity and lights",
            ["GreasePencilLayer"],
            ["GreasePencilLayer.opacity", "GreasePencilLayer.use_lights"],
        ),
        (
            "camera depth of field focus object fstop blades",
            ["CameraDOFSettings"],
            [
                "CameraDOFSettings.use_dof",
                "CameraDOFSettings.focus_object",
                "CameraDOFSettings.aperture_fstop",
                "CameraDOFSettings.aperture_blades",
            ],
        ),
        # Of another class where that is named as well.
        (
            "hook and lattice modifier strength",
            ["HookModifier.vertex_group", "LatticeModifier.object"],
            ["HookModifier.strength", "LatticeModifier.strength"],
        ),
        # As it is written, though all its words are another's.
        (
            "frame_final_start, frame_start, frame_offset_start",
            ["Strip.frame_final_start", "Scene.frame_start"],
            ["Strip.frame_start", "Strip.frame_offset_start"],
        ),
    ],
)  # fmt: skip
def test_each_word_of_a_list_asks_for_a_member(
    question: str, ids: list[str], members: list[str], kb: KnowledgeBase
) -> None:
    assert sorted(asked(question, kb, *ids)) == sorted(members)


@pytest.mark.parametrize(
    ("question", "ids"),
    [
        ("campfire with rising smoke", ["FluidDomainSettings.beta"]),  # says nothing but what it is about
        ("transparent background png, no sky", ["RenderSettings.film_transparent"]),  # by chance
        ("different tint for each copy of the same object", ["Object.color", "Node.label"]),
        ("bevel modifier", ["BevelModifier"]),
    ],
)
def test_words_by_chance_ask_for_none(question: str, ids: list[str], kb: KnowledgeBase) -> None:
    assert not asked(question, kb, *ids)


def test_behind_a_page_they_are_the_first_names(kb: KnowledgeBase) -> None:
    rows = [RankedId(f"{T}ClothSettings.mass", 1.0, "found")]
    first = f"{T}ClothSettings.quality"
    (block,) = HitLines(kb.reader).further(hits_of(rows, kb.reader), rows, first=[first])
    assert [line.split("`")[1] for line in block.text.split("\n")[1:]] == [first, f"{T}ClothSettings.mass"]


def test_beside_another_member_they_stand_before_its_values(kb: KnowledgeBase) -> None:
    text = kb.query("bevel modifier segments width limit method").text
    before, _, after = text.partition("**Values**")
    assert f"**Asked for**\n- `{T}BevelModifier.segments`" in before
    assert f"`{T}BevelModifier.segments`" not in after


def test_code_says_itself_whose_they_are(kb: KnowledgeBase) -> None:
    text = kb.query('obj.modifiers["Bevel"].width = obj.modifiers["Bevel"].segments').text
    assert "**Asked for**" not in text


def test_sockets_are_asked_for_by_type_and_side(kb: KnowledgeBase) -> None:
    node = "FunctionNodeRandomValue"
    (found,) = asked("Random Value node integer output socket", kb, node)
    assert kb.reader.entry(T + found).type == "int"  # pyright: ignore[reportOptionalMemberAccess]
    assert found.startswith(f"{node}.outputs[")
    names = asked("Set Position node inputs offset and selection", kb, "GeometryNodeSetPosition")
    assert names == [f'GeometryNodeSetPosition.inputs["{name}"]' for name in ("Offset", "Selection")]


@pytest.mark.parametrize(
    ("question", "line"),
    [
        ("driver on a constraint influence", '.constraints[0].driver_add("influence")`'),
        ("keyframe the strength of a displace modifier", '.keyframe_insert("strength", frame=1)`'),
    ],
)
def test_it_is_told_how_what_is_asked_for_is_animated(question: str, line: str, kb: KnowledgeBase) -> None:
    (told,) = (one for one in kb.query(question).text.split("\n") if one.startswith("animated by `"))
    assert told.endswith(line)


@pytest.mark.parametrize("question", ["strength of a displace modifier", "turn physics motion to keyframes"])
def test_what_is_not_named_or_not_animated_has_no_such_line(question: str, kb: KnowledgeBase) -> None:
    assert "animated by `" not in kb.query(question).text
