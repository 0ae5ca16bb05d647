"""The uses of symbols in scripts, and which of them are shown."""

from __future__ import annotations

import ast
from contextlib import closing
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.usage.examples import MOST_EXAMPLES, Example, Uses, clearest, uses_in

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SCRIPT = """
    import bpy

    def drape(ob):
        cloth = ob.modifiers.new("Cloth", 'CLOTH')
        cloth.settings.quality = 12
        if cloth.settings.quality > 5:
            print(cloth.settings.quality)

    def draw(self, context):
        layout = self.layout
        layout.operator("object.shade_smooth")
        layout.prop(context.scene.render, "fps")

    bpy.types.VIEW3D_MT_object.append(draw)
    drape(bpy.context.object)
    bpy.ops.mesh.primitive_cube_add(
        size=2,
        location=(0, 0, 1),
        rotation=(0, 0, 0),
    )
    for ob in bpy.context.selected_objects:
        ob.location.z += 1
"""


@pytest.fixture(scope="module")
def found(base: Path) -> Iterator[dict[str, Uses]]:
    with closing(BaseSymbols(base)) as symbols:
        yield uses_in(dedent(SCRIPT), "a/script.py", Api(symbols), (5, 1, 0))


def shown(found: dict[str, Uses], path: str) -> str:
    return found[path].examples[0].code


def test_a_setting_is_shown_where_it_is_set_with_the_line_that_binds_its_owner(
    found: dict[str, Uses],
) -> None:
    uses = found["bpy.types.ClothSettings.quality"]
    assert (uses.count, uses.files) == (3, 1)
    best = uses.examples[0]
    assert best.code == "cloth = ob.modifiers.new(\"Cloth\", 'CLOTH')\ncloth.settings.quality = 12"
    assert (best.file, best.line) == ("a/script.py", 5)


def test_a_call_of_many_lines_is_shown_on_one(found: dict[str, Uses]) -> None:
    call = "bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1), rotation=(0, 0, 0))"
    assert shown(found, "bpy.ops.mesh.primitive_cube_add") == call


def test_what_is_looped_over_is_shown_with_its_loop(found: dict[str, Uses]) -> None:
    expected = "for ob in bpy.context.selected_objects:\n    ob.location.z += 1"
    assert shown(found, "bpy.types.Object.location") == expected


def test_a_class_is_shown_where_an_instance_is_made(found: dict[str, Uses]) -> None:
    assert shown(found, "bpy.types.ClothModifier") == "cloth = ob.modifiers.new(\"Cloth\", 'CLOTH')"


def test_a_button_counts_as_a_use_but_does_not_tell_how_its_symbol_is_used(found: dict[str, Uses]) -> None:
    for path in ("bpy.ops.object.shade_smooth", "bpy.types.RenderSettings.fps"):
        assert found[path].count == 1
        assert not found[path].examples


def test_every_line_that_is_shown_is_in_the_script(found: dict[str, Uses]) -> None:
    text = squeezed(SCRIPT) + "..."  # which stands for the lines below a head
    examples = [example for uses in found.values() for example in uses.examples]
    assert len(examples) > 20
    for example in examples:
        lines = example.code.split("\n")
        assert len(lines) <= 3
        assert all(squeezed(line) in text for line in lines)


def squeezed(code: str) -> str:
    """Code without its white space, and without the comma behind a last argument."""
    return "".join(code.split()).replace(",)", ")")


def test_a_script_that_cannot_be_read_has_no_uses(base: Path) -> None:
    with closing(BaseSymbols(base)) as symbols:
        assert uses_in("print 'x'", "a", Api(symbols), ()) == {}


def test_the_clearest_are_kept_and_the_same_code_once() -> None:
    rows = [
        Example(cost, "f", line, code)
        for cost, line, code in ((3, 1, "c"), (1, 2, "a"), (2, 3, "a"), (2, 4, "b"))
    ]
    assert [row.code for row in clearest(rows)] == ["a", "b", "c"]
    assert len(clearest([Example(n, "f", n, str(n)) for n in range(9)])) == MOST_EXAMPLES


def test_uses_in_several_files_are_added_up() -> None:
    uses = Uses(2, 1, [Example(2, "f", 1, "two")])
    uses.add(Uses(3, 1, [Example(1, "g", 1, "one")]))
    assert (uses.count, uses.files, [row.code for row in uses.examples]) == (5, 2, ["one", "two"])


def test_presets_that_run_from_a_panel_show_nothing(base: Path) -> None:
    preset = "import bpy\nbpy.context.cloth.settings.mass = 1\nbpy.context.scene.render.fps = 24\n"
    with closing(BaseSymbols(base)) as symbols:
        api = Api(symbols)
        found = {name: uses_in(preset, name, api, (5, 1, 0)) for name in ("presets/a.py", "startup/a.py")}
    mass, fps = "bpy.types.ClothSettings.mass", "bpy.types.RenderSettings.fps"
    assert (found["presets/a.py"][mass].count, found["presets/a.py"][mass].examples) == (1, [])
    assert found["presets/a.py"][fps].examples
    assert found["startup/a.py"][mass].examples


def test_a_binding_is_shown_only_where_the_run_comes_through_it(base: Path) -> None:
    script = dedent("""
        import bpy

        def save(path, values, writer):
            if writer:
                image = writer.create(path)
                image.write(values)
                return
            image = bpy.data.images.new("a", 8, 8)
            if path:
                image.pixels = values
            else:
                pixels = values
            image.filepath = pixels
    """)
    with closing(BaseSymbols(base)) as symbols:
        found = uses_in(script, "a.py", Api(symbols), (5, 1, 0))
    made = 'image = bpy.data.images.new("a", 8, 8)\n'
    assert shown(found, "bpy.types.Image.pixels") == f"{made}image.pixels = values"
    assert shown(found, "bpy.types.Image.filepath") == f"{made}image.filepath = pixels"


PANELS = """
    import bpy
    from bpy.types import Panel

    class Sidebar(Panel):
        '''Words'''
        bl_label = "Demo"  # as it is shown
        bl_space_type = 'VIEW_3D'
        bl_region_type = 'UI'

        @classmethod
        def poll(cls, context):
            return context.object.type == 'MESH'

        def draw(self, context):
            field = context.object.field
            if field.type == 'WIND':
                field.strength = 1
            elif field.shape == 'PLANE':
                field.flow = 2
            md = context.fluid
            domain = md.domain_settings
            bpy.context.object.data.splines[0].bezier_points.add()

    ignored = (bpy.types.Panel, bpy.types.Menu)
    for modifier in bpy.context.object.modifiers:
        domain = modifier.domain_settings
    for dup in bpy.context.evaluated_depsgraph_get().object_instances:
        shown = dup.instance_object
        print(shown.name, dup.matrix_world)
"""


@pytest.fixture(scope="module")
def of_panels(base: Path) -> Iterator[dict[str, Uses]]:
    with closing(BaseSymbols(base)) as symbols:
        yield uses_in(dedent(PANELS), "a/script.py", Api(symbols), (5, 1, 0))


def test_a_class_is_shown_where_another_derives_from_it_and_not_as_a_value(
    of_panels: dict[str, Uses],
) -> None:
    assert shown(of_panels, "bpy.types.Panel") == dedent("""\
        class Sidebar(Panel):
            bl_label = "Demo"
            bl_space_type = 'VIEW_3D'
            bl_region_type = 'UI'

            def draw(self, context): ...""")
    assert (of_panels["bpy.types.Menu"].count, of_panels["bpy.types.Menu"].examples) == (1, [])


def test_every_example_can_be_read_by_itself(of_panels: dict[str, Uses]) -> None:
    for uses in of_panels.values():
        for example in uses.examples:
            ast.parse(example.code)
    field = "field = context.object.field\n"
    assert shown(of_panels, "bpy.types.FieldSettings.shape") == (
        f"{field}if field.shape == 'PLANE':\n    ..."
    )
    assert shown(of_panels, "bpy.types.Object.type") == "context.object.type == 'MESH'"


def test_a_call_without_what_its_function_requires_is_no_example(of_panels: dict[str, Uses]) -> None:
    for path in ("bpy.types.SplineBezierPoints.add", "bpy.types.Spline.bezier_points"):
        assert (of_panels[path].count, of_panels[path].examples) == (1, [])


def test_what_runs_in_some_editors_only_comes_last(of_panels: dict[str, Uses]) -> None:
    settings = of_panels["bpy.types.FluidModifier.domain_settings"].examples
    assert [example.cost > 20 for example in settings] == [True]
    assert "context.fluid" in settings[0].code
    assert of_panels["bpy.types.FieldSettings.flow"].examples[0].cost < 20


def test_what_a_loop_binds_stands_above_what_is_made_of_it(of_panels: dict[str, Uses]) -> None:
    assert shown(of_panels, "bpy.types.DepsgraphObjectInstance.matrix_world").startswith(
        "for dup in bpy.context.evaluated_depsgraph_get().object_instances:\n    shown = dup.instance_object\n"
    )


def test_a_decorator_is_shown_above_a_function(base: Path) -> None:
    script = dedent("""
        import bpy
        from bpy.app.handlers import persistent

        @persistent
        def after_loading(path):
            print(path)
    """)
    with closing(BaseSymbols(base)) as symbols:
        found = uses_in(script, "a.py", Api(symbols), (5, 1, 0))
    expected = "@persistent\ndef after_loading(path): ..."
    assert shown(found, "bpy.app.handlers.persistent") == expected


def test_a_call_that_only_some_classes_below_have_shows_none_of_them(base: Path) -> None:
    driver = "bpy.context.object.animation_data.drivers[0].driver"
    code = f"import bpy\ndata = {driver}.variables[0].targets[0].id\ndata.update()\nbpy.data.meshes[0].update()\n"
    with closing(BaseSymbols(base)) as symbols:
        found = uses_in(code, "a/script.py", Api(symbols), (5, 1, 0))
    assert "bpy.types.NodeTree.update" not in found
    assert found["bpy.types.Mesh.update"].count == 1


def test_what_an_objects_data_has_is_no_use_of_what_no_object_has(base: Path) -> None:
    code = "import bpy\nbpy.context.object.data.layers.active\n"
    with closing(BaseSymbols(base)) as symbols:
        found = uses_in(code, "a/script.py", Api(symbols), (5, 1, 0))
    assert "bpy.types.CacheFileLayers.active" not in found
    assert found["bpy.types.GreasePencilv3Layers.active"].count == 1


def test_a_call_that_one_class_below_has_is_a_use_of_it(base: Path) -> None:
    code = "import bpy\ndata = bpy.context.object.data\ndata.view_frame(scene=bpy.context.scene)\n"
    with closing(BaseSymbols(base)) as symbols:
        found = uses_in(code, "a/script.py", Api(symbols), (5, 1, 0))
    assert found["bpy.types.Camera.view_frame"].count == 1
