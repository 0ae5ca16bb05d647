"""What scripts write for tasks that take several calls: each is tried in Blender."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import pytest

from kb_serve.answer.known.task_sentences import TASK_SENTENCES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_serve.knowledge_base import KnowledgeBase

bpy: Any = pytest.importorskip("bpy")
bmesh: Any = pytest.importorskip("bmesh")
mathutils: Any = pytest.importorskip("mathutils")
pytestmark = pytest.mark.blender
Matrix, Vector = mathutils.Matrix, mathutils.Vector
CODE = re.compile(r"`([^`]+)`")


@pytest.fixture(autouse=True)
def start_up_file() -> Iterator[None]:
    """Each test has a new file with the start-up objects."""
    bpy.ops.wm.read_factory_settings()
    yield
    bpy.ops.wm.read_factory_settings(use_empty=True)


def updated() -> None:
    bpy.context.view_layer.update()


def cube() -> Any:
    return bpy.data.objects["Cube"]


def told(kb: KnowledgeBase, question: str) -> str:
    """The one recipe that an answer tells."""
    notes = kb.query(question).notes
    (text,) = (recipe.text for recipe in TASK_SENTENCES if recipe.text in notes)
    return text


def run(text: str, *left_out: int, **names: Any) -> dict[str, Any]:
    """Runs the statements of a recipe, but for some of them, with some names."""
    held = {"bpy": bpy, "bm": None, "math": math, "Matrix": Matrix, "Vector": Vector, **names}
    for number, code in enumerate(CODE.findall(text)):
        if number not in left_out and ("(" in code or "=" in code):
            exec(code, held)
    return held


def test_a_moved_objects_matrix_is_updated_first(kb: KnowledgeBase) -> None:
    ob = cube()
    ob.location.x = 5
    assert ob.matrix_world.translation.x == 0
    run(told(kb, "matrix_world not updated after setting location"))
    assert ob.matrix_world.translation.x == 5


@pytest.mark.parametrize(
    ("question", "adds"),
    [
        ("convert a metaball to a mesh", bpy.ops.object.metaball_add),
    ],
)
def test_what_has_a_surface_becomes_a_mesh(
    question: str, adds: Callable[[], object], kb: KnowledgeBase
) -> None:
    adds()
    assert len(run(told(kb, question), ob=bpy.context.object)["mesh"].vertices) > 0


def corners(ob: Any) -> list[float]:
    updated()
    return [number for vertex in ob.data.vertices for number in ob.matrix_world @ vertex.co]


def value(text: str, **names: Any) -> Any:
    """What the first code of a recipe gives."""
    return eval(CODE.findall(text)[0], {"Vector": Vector, **names})


def test_a_normal_holds_for_any_scale(kb: KnowledgeBase) -> None:
    ob = cube()
    ob.data.vertices[0].co.x += 0.5
    ob.scale = (1, 2, 3)
    updated()
    polygon = ob.data.polygons[0]
    a, b, c = (ob.matrix_world @ ob.data.vertices[number].co for number in polygon.vertices[:3])
    normal = value(told(kb, "get the face normal in world space"), ob=ob, polygon=polygon)
    assert abs(normal.dot((b - a).cross(c - b).normalized())) > 0.9


@pytest.mark.parametrize(
    "question",
    [
        "store custom data in the scene that is saved in the file",
    ],
)
def test_anything_takes_properties_of_its_own(question: str, kb: KnowledgeBase) -> None:
    run(told(kb, question), ob=cube())
    assert (cube()["speed"], cube().speed) == (1.0, 0.0)
    del bpy.types.Object.speed


def test_an_origin_moves_and_what_is_seen_stays(kb: KnowledgeBase) -> None:
    ob, place = cube(), Vector((1, 1, 0))
    ob.scale, ob.rotation_euler.z = (1, 2, 3), 0.5
    before = corners(ob)
    run(told(kb, "how to change the origin of an object"), 0, ob=ob, place=place)
    assert corners(ob) == pytest.approx(before, abs=1e-5)
    assert tuple(ob.data.vertices[0].co) == pytest.approx((0, 0, 1))


@pytest.mark.parametrize(
    "question",
    [
        "bpy.ops.object.visual_transform_apply()",
        "bpy.ops.object.duplicates_make_real(use_base_parent=True)",
        "euler degrees to quaternion and smooth blend of two rotations",
        "copy modifiers from one object to another",
        "curve to mesh node",
        "limit distance between objects constraint",
        "make the camera look at an empty with track to",
        "camera keeps looking at a cube, script",
        "how to select all objects",
        "add a custom property to a panel",
        "toggle the sidebar",
        "transparent background png",
        "hide the hdri in the viewport",
        "remove grease pencil strokes",
        "origin of a text object",
    ],
)
def test_a_question_of_something_else_is_told_none(question: str, kb: KnowledgeBase) -> None:
    assert not {recipe.text for recipe in TASK_SENTENCES}.intersection(kb.query(question).notes)


def test_vertices_are_placed_in_the_world(kb: KnowledgeBase) -> None:
    text = told(kb, "get the global coordinates of all vertices")
    ob = cube()
    ob.location.x = 5
    updated()
    places = eval(CODE.findall(text)[0], {"ob": ob})
    assert max(place.x for place in places) == pytest.approx(6)


def test_a_socket_has_the_limits_of_its_class_or_its_group(kb: KnowledgeBase) -> None:
    text = told(kb, "how do I get the min and max of a node socket's slider")
    socket = cube().active_material.node_tree.nodes["Principled BSDF"].inputs["Roughness"]
    held: dict[str, Any] = {"socket": socket}
    exec(CODE.findall(text)[0], held)
    limits = held["limits"]
    assert (limits.hard_min, limits.soft_min, limits.soft_max, limits.hard_max) == (0, 0, 1, 1)
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    own = tree.interface.new_socket("Size", in_out="INPUT", socket_type="NodeSocketFloat")
    own.max_value = 2
    assert tree.interface.items_tree["Size"].max_value == 2
    node = cube().active_material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = tree
    assert node.inputs["Size"].bl_rna.properties["default_value"].hard_max > 2


def test_a_part_of_a_question_is_told_what_one_has_to_know(kb: KnowledgeBase) -> None:
    answer = kb.query("get rendered image pixels without saving to disk, Render Result pixels are empty").text
    assert "parts, each answered in brief" in answer
    assert "has no pixels to read" in answer


def test_a_pose_bone_is_turned_by_its_mode() -> None:
    bpy.ops.object.armature_add()
    ob = bpy.context.object
    bone = ob.pose.bones[0]
    for mode, is_turned in (("QUATERNION", False), ("XYZ", True)):
        bone.rotation_mode = mode
        bone.rotation_euler = (1, 0, 0)
        updated()
        assert (bone.matrix_basis != Matrix()) == is_turned
        bone.rotation_euler = (0, 0, 0)


def test_a_driver_calls_a_function_of_ones_own(kb: KnowledgeBase) -> None:
    (text,) = (
        note for note in kb.query("driver expression with my own function").notes if "namespace" in note
    )
    statement = next(code for code in CODE.findall(text) if "namespace" in code)
    exec(statement, {"bpy": bpy, "name": lambda frame: 2 * frame})
    ob = cube()
    ob.driver_add("location", 0).driver.expression = "name(frame)"
    bpy.context.scene.frame_set(4)
    assert ob.location.x == 8


def test_an_f_curve_has_a_value_at_any_frame(kb: KnowledgeBase) -> None:
    text = told(kb, "get the value of an fcurve at a frame")
    ob = cube()
    for frame, ob.location.x in ((1, 0), (11, 10)):
        ob.keyframe_insert("location", index=0, frame=frame)
    animated = ob.animation_data
    (fcurve,) = animated.action.layers[0].strips[0].channelbag(animated.action_slot).fcurves
    assert eval(CODE.findall(text)[0], {"fcurve": fcurve, "frame": 6}) == pytest.approx(5)


def test_a_ray_from_the_mouse_gives_six_values(kb: KnowledgeBase) -> None:
    text = told(kb, "which object is under the mouse cursor, ray cast")
    cast = CODE.findall(text)[-1]
    held: dict[str, Any] = {"context": bpy.context, "origin": (0, 0, 9), "direction": (0, 0, -1)}
    exec(cast, held)
    assert held["hit"]
    assert held["ob"].name == "Cube"
