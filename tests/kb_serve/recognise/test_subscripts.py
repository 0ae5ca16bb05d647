"""Text in brackets behind what is no collection is a custom property, or an input of a geometry-nodes modifier."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    "query",
    [
        'modifier["Socket_2"] = 5.0',
        'obj.modifiers["GeometryNodes"]["Input_2"] = 5.0',
        'mod["Socket_2"]',
        "how do I set a geometry nodes modifier input value from Python",
        "change the value of an input of a geometry nodes modifier from python",
        "How do I set a geometry nodes modifier's input?",
        "set the Size parameter of my geometry nodes",
        "animate a geometry node modifier's slider",
    ],
)
def test_inputs_of_a_geometry_nodes_modifier_are_set_by_identifier(kb: KnowledgeBase, query: str) -> None:
    notes = "\n".join(kb.query(query).notes)
    assert 'modifier[modifier.node_group.interface.items_tree["Size"].identifier] = 5.0' in notes
    assert "A menu takes the number of an entry, which is not its index" in notes
    assert "has no" not in notes


@pytest.mark.parametrize(
    "query",
    [
        "add an input to a geometry nodes modifier",
        "set a value of the array modifier",
        "geometry nodes",
    ],
)
def test_inputs_are_not_told_of_where_others_are_asked_for(kb: KnowledgeBase, query: str) -> None:
    assert not any("Inputs of a geometry-nodes modifier" in note for note in kb.query(query).notes)


@pytest.mark.parametrize(
    ("query", "cls"),
    [
        ('scene["my_prop"] = 3', "Scene"),
        ('obj["health"]', "Object"),
        ('pose.bones["Arm"]["ik_fk"]', "PoseBone"),
    ],
)
def test_a_custom_property_is_no_attribute(kb: KnowledgeBase, query: str, cls: str) -> None:
    (note,) = kb.query(query).notes
    assert f"is a custom property of `bpy.types.{cls}`" in note


def test_what_takes_no_custom_properties_says_so(kb: KnowledgeBase) -> None:
    answer = kb.query('obj.constraints["Copy Location"]["influence"] = 0.5')
    assert answer.hits[0].id == "bpy.types.Constraint.influence"
    assert "takes no custom properties" in answer.notes[0]


def test_a_variable_called_context_may_be_a_dictionary(kb: KnowledgeBase) -> None:
    answer = kb.query("context = bpy.context.copy(); context['object'] = ob")
    assert not any("custom properties" in note for note in answer.notes)
