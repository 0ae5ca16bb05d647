"""The steps of a topic lead to what does something: each thing on the object that it belongs to, and whole."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from asking import TYPES, steps

from kb_build.pages.page import Page, Section
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.answer.steps.names.topic_names import TopicNames
from kb_serve.answer.steps.order import Steps, numbered
from kb_serve.reader import BaseReader
from measurements.steps import do_steps

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def told_of(
    reader: BaseReader, topic: str, classes: Sequence[str] = (), operators: Sequence[str] = ()
) -> list[str]:
    """The steps of a topic with some classes and operators, the heaviest first."""
    names = TopicNames(
        frozenset({topic.replace(" ", "")}),
        (frozenset(topic.split()),),
        classes={f"{TYPES}{name}": 10.0 - place for place, name in enumerate(classes)},
        operators={f"bpy.ops.{name}": 10.0 - place for place, name in enumerate(operators)},
        title=topic.replace(" ", ""),
    )
    return numbered(Steps(reader, names).told())


def are_done(told: list[str]) -> bool:
    """Whether all steps can be done in Blender."""
    (done,) = do_steps({"topic": told})
    return bool(told) and not done.failed and not done.left


def test_a_driver_is_told_up_to_what_it_reads(reader: BaseReader) -> None:
    told = steps(reader, "driver", "Driver", "DriverVariable", "DriverTarget")
    assert "set on `variable.targets[0]` (`DriverTarget`): " in told[-1]
    assert "`data_path`" in told[-1]
    assert "`id` = None (ID)" in told[-1]
    assert are_done(told)


def test_elements_that_a_new_thing_need_not_have_are_not_set(reader: BaseReader) -> None:
    told = " ".join(steps(reader, "uv", "MeshUVLoopLayer", "MeshUVLoop"))
    assert "uv_layers.new()" in told
    assert "[0]`" not in told


def test_what_changes_another_object_is_told_with_the_modifier_of_that_one(reader: BaseReader) -> None:
    told = steps(reader, "lattice", "Lattice", "LatticeModifier", "LatticePoint")
    made = [line for line in told if "modifiers.new(" in line]
    assert len(made) == 1
    assert "on another object, that it changes: `modifier = other.modifiers.new(" in made[0]
    assert "set on `modifier` (`LatticeModifier`): " in told[told.index(made[0]) + 1]
    assert are_done(told)


def test_what_lets_an_operator_run_is_set_on_the_first_of_several_things(reader: BaseReader) -> None:
    classes = ("FluidModifier", "FluidDomainSettings", "FluidFlowSettings")
    told = told_of(reader, "fluid", classes, ("fluid.bake_all", "fluid.bake_data"))
    all_, parts = (
        next(place for place, line in enumerate(told) if f"bpy.ops.fluid.{name}()" in line)
        for name in ("bake_all", "bake_data")
    )
    assert told[all_ - 1].endswith("`modifier.domain_settings.cache_type = 'ALL'`")
    assert told[parts - 1].endswith("instead: `modifier.domain_settings.cache_type = 'MODULAR'`")
    assert are_done(told)


def test_a_modifier_that_is_bound_is_run_by_its_operator(reader: BaseReader) -> None:
    told = told_of(reader, "mesh deform", ("MeshDeformModifier",))
    assert "`bpy.ops.object.meshdeform_bind(modifier=modifier.name)`" in told[-1]
    assert are_done(told)
    told = " ".join(told_of(reader, "hook", ("HookModifier",)))
    assert "mode_set(mode='EDIT')" in told
    assert "hook_assign(modifier=modifier.name)" in told
    assert "hook_remove" not in told


def test_the_strips_of_an_effect_are_made_before_it(reader: BaseReader) -> None:
    told = told_of(reader, "cross strip", ("CrossStrip",))
    place = next(place for place, line in enumerate(told) if "input1=input1, input2=input2" in line)
    assert [line.partition("`")[2].partition(" ")[0] for line in told[place - 2 : place]] == [
        "input1",
        "input2",
    ]
    assert are_done(told)


def test_what_only_a_file_makes_is_loaded(reader: BaseReader) -> None:
    told = told_of(reader, "tracking", ("MovieTracking", "MovieTrackingTrack"))
    assert told[0] == "1. `clip = bpy.data.movieclips.load(filepath)`; `scene.active_clip = clip`"
    assert any("`track = clip.tracking.tracks.new()`" in line for line in told)


def test_what_a_step_has_made_no_operator_makes_again(reader: BaseReader) -> None:
    told = told_of(
        reader, "shape keys", ("ShapeKey",), ("object.shape_key_mirror", "object.shape_key_retime")
    )
    assert "shape_key_mirror(" in " ".join(told)
    made = [line for line in told if "obj.shape_key_add(" in line.partition(" — ")[0]]
    assert len(made) == 2  # the basis, and a key
    assert are_done(told)


def test_what_an_area_alone_makes_is_no_step_beside_others(reader: BaseReader) -> None:
    told = " ".join(told_of(reader, "movie strip", ("MovieStrip", "MovieClipStrip")))
    assert "strips.new_movie(" in told
    assert "movieclip_strip_add" not in told
    assert "movieclip_strip_add" in " ".join(told_of(reader, "clip strip", ("MovieClipStrip",)))


def test_steps_that_have_no_room_take_what_only_prepares_them_along(reader: BaseReader) -> None:
    classes = ("FluidModifier", "FluidDomainSettings", "FluidFlowSettings", "FluidEffectorSettings")
    bakes = tuple(f"fluid.bake_{name}" for name in ("all", "data", "mesh", "noise"))
    told = told_of(reader, "fluid", classes, bakes)
    assert "bake_noise" not in " ".join(told)
    assert "`bpy.ops.fluid." in told[-1]


def test_an_operator_is_run_in_the_mode_that_heads_what_the_manual_says_of_it(
    tmp_path: Path, reader: BaseReader
) -> None:
    assign, slug = "bpy.ops.object.material_slot_assign", "render/materials/assignment"
    owners = ("Object", "ID", "bpy_struct")
    paths = [assign, *(f"{TYPES}{owner}" for owner in owners)]
    paths += [entry.path for owner in owners for entry in reader.members(f"{TYPES}{owner}").values()]
    for title, entered in (("Edit Mode", True), ("Slots", False)):
        said = (
            "Faces get it.\n\n**Assign Material Slot**\n  Assign active material slot to the selected faces."
        )
        sections = (Section("top", "Assignment", 1, "Materials."), Section("mode", title, 2, said))
        folder = tmp_path / title
        folder.mkdir()
        symbols = tuple(symbol for path in paths if (symbol := reader.symbol(path)))
        links = (Link(assign, slug, "manual"),)
        page = Page(slug, "manual", "5.1", "Assignment", sections)
        write_base(folder / "base.sqlite", Contents(symbols, (page,), links, {}))
        with closing(BaseReader(folder / "base.sqlite")) as own:
            assert own.manual.passage(assign)
            told = " ".join(told_of(own, "assignment", (), ("object.material_slot_assign",)))
        assert "material_slot_assign()" in told
        assert ("mode_set(mode='EDIT')" in told) is entered


def test_an_action_is_given_with_the_slot_that_moves_things(reader: BaseReader) -> None:
    """Of an object and of a strip; the channels that are made then are of that slot."""
    found = steps(reader, "actions", "Action", "ActionSlot", "ActionChannelbag")
    (given,) = [number for number, line in enumerate(found) if "animation_data.action = action`" in line]
    assert "`slot = action.slots.new(" in found[given + 1]
    assert "`obj.animation_data.action_slot = slot`" in found[given + 2]
    assert sum("`slot = " in line for line in found) == 1
    (bag,) = [number for number, line in enumerate(found) if "channelbags.new(slot)" in line]
    assert bag > given
    strips = steps(reader, "nla", "NlaTrack", "NlaStrip")
    assert "`strip.action_slot = slot`" in " ".join(strips)
    assert are_done(found)
    assert are_done(strips)


def test_where_an_action_is_a_setting_so_is_its_slot(reader: BaseReader) -> None:
    (settings,) = [line for line in steps(reader, "action", "ActionConstraint") if "set on" in line]
    assert "`action` = None (Action), `action_slot` (after `action`) = None (ActionSlot)" in settings
    assert "action_slot_handle" not in settings
    assert are_done(steps(reader, "action", "ActionConstraint"))


def test_a_node_that_ends_a_tree_is_linked_to_what_goes_through_it(reader: BaseReader) -> None:
    told = steps(reader, "viewer", "CompositorNodeViewer")
    assert '`tree.links.new(render_layers.outputs["Image"], viewer.inputs["Image"])`' in " ".join(told)
    assert are_done(told)
    told = steps(reader, "output", "ShaderNodeOutputWorld")
    assert '.new(tree.nodes["Background"].outputs["Background"], ' in told[-1]
    assert are_done(told)


@pytest.mark.parametrize("node", ["ShaderNodeMixShader", "ShaderNodeAddShader"])
def test_a_node_that_joins_shaders_has_one_in_each_input(reader: BaseReader, node: str) -> None:
    told = steps(reader, "shader", node)
    links = [line for line in told if "links.new(" in line]
    assert 'tree.nodes["Principled BSDF"].outputs["BSDF"], shader.inputs["Shader"]' in links[0]
    assert 'emission.outputs["Emission"], shader.inputs["Shader_001"]' in links[1]
    assert "tree.get_output_node('ALL').inputs[\"Surface\"]" in links[2]
    assert are_done(told)


def test_what_makes_a_colour_of_a_shader_is_shown_itself(reader: BaseReader) -> None:
    told = steps(reader, "shader to rgb", "ShaderNodeShaderToRGB")
    assert 'outputs["BSDF"], rgb.inputs["Shader"]' in told[-2]
    assert "tree.get_output_node('ALL').inputs[\"Surface\"]" in told[-1]
    assert are_done(told)


def test_operators_on_objects_of_another_type_than_is_made_are_no_steps(reader: BaseReader) -> None:
    """Nor are others of their module, that work on the same."""
    of_hair = ("curves.split", "curves.convert_from_particle_system")
    for cls, runs in (("Curve", False), ("Curves", True)):
        told = " ".join(told_of(reader, "curves", (cls,), of_hair))
        assert "objects.link(obj)" in told
        assert ("`bpy.ops.curves.split()`" in told) is runs
        assert ("bpy.ops.curves." in told) is runs


def test_what_only_shows_what_is_done_is_no_step_beside_what_does_it(reader: BaseReader) -> None:
    shows = ("render.play_rendered_anim", "render.view_show")
    told = told_of(reader, "render", (), ("render.render", *shows))
    assert [line.partition("`")[2].partition("(")[0] for line in told[1:]] == ["bpy.ops.render.render"]
    assert "play_rendered_anim" in " ".join(told_of(reader, "render", (), shows))


def test_a_render_is_kept_in_a_file(reader: BaseReader) -> None:
    path, run = told_of(reader, "render", (), ("render.render",))
    assert "`scene.render.filepath = " in path
    assert "render(write_still=True, " in run
    assert run.count("write_still") == 1


def test_what_a_bake_is_of_is_made_before_it(reader: BaseReader) -> None:
    told = told_of(reader, "gas", (), ("fluid.bake_noise",))
    assert "`modifier = obj.modifiers.new(\"Fluid\", 'FLUID')`" in told[0]
    assert "`modifier.domain_settings.use_noise = True`" in " ".join(told)
    assert "`bpy.ops.fluid.bake_noise()`" in told[-1]
    assert are_done(told)


def test_an_object_is_given_its_parent_and_stays_where_it_is(reader: BaseReader) -> None:
    told = told_of(reader, "parent", (), ("object.parent_set",))
    assert "`obj.parent = other`" in told[0]
    assert "`obj.matrix_parent_inverse = other.matrix_world.inverted()`" in told[1]
    assert are_done(told)
