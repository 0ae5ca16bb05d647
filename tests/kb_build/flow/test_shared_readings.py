"""What several types, calls or ways of running a script have in common: nothing is sure that holds for one alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flow_reading import symbol, unknown

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api


def test_a_socket_is_missing_only_if_no_node_that_it_can_be_has_it(api: Api) -> None:
    code = """
        import bpy
        tree = bpy.data.materials.new("m").node_tree
        place, ramp = (tree.nodes.new(kind) for kind in ("ShaderNodeTexCoord", "ShaderNodeValToRGB"))
        place.outputs["Object"]
        ramp.outputs["Alpha"]
        ramp.outputs["Nonsense"]
    """
    assert unknown(api, code) == {("ShaderNodeTexCoord", "Nonsense")}


def test_what_a_function_returns_is_not_known_from_other_calls(api: Api) -> None:
    calls = "".join(
        f"\n        a{number} = node('{kind}')"
        for number, kind in enumerate(
            f"ShaderNode{name}" for name in ("TexCoord", "ObjectInfo", "Math", "TexNoise", "Bump", "Mapping")
        )
    )
    code = f"""
        import bpy
        tree = bpy.data.materials.new("m").node_tree
        def node(kind):
            return tree.nodes.new(kind){calls}
        ramp = node("ShaderNodeValToRGB")
        ramp.color_ramp
        ramp.outputs["Alpha"]
    """
    assert unknown(api, code) == set()


def test_bpy_need_not_be_imported(api: Api) -> None:
    assert unknown(api, "bpy.context.scene.nonsense") == {("Scene", "nonsense")}
    assert symbol(api, "def f():\n    return bpy.context.scene.camera", "camera") == "Scene.camera"


def test_a_script_that_suppresses_errors_is_believed(api: Api) -> None:
    for manager in ("contextlib.suppress(AttributeError)", "suppress(KeyError, Exception)"):
        assert unknown(api, f"with {manager}:\n    bpy.context.scene.nonsense") == set()
    assert unknown(api, "with suppress(OSError):\n    bpy.context.scene.nonsense") == {("Scene", "nonsense")}
