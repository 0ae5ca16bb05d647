"""What a migration does beyond single rewrites: guards, rounds, what is left, lines, hostile input."""

from __future__ import annotations

import ast
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from kb_check.migrate.kept_version import KeptVersion
from kb_check.migrate.plan import FileMigration, Migrator

if TYPE_CHECKING:
    from kb_check.checker import Checker


def migrated(checker: Checker, code: str, *keep: tuple[int, int]) -> FileMigration:
    versions = [KeptVersion(version) for version in keep]
    (file,) = Migrator(checker, versions).migrate({"script.py": dedent(code)})
    return file


def test_types_that_a_missing_name_hid_are_known_in_the_next_round(checker: Checker) -> None:
    code = """\
    import bpy
    lamp = bpy.data.lamps.new("L", 'SUN')
    lamp.shadow_method = 'RAY'
    """
    file = migrated(checker, code)
    assert "bpy.data.lights.new(\"L\", 'SUN')" in file.new
    assert [one.line for one in file.decisions] == [3]


def test_an_older_version_keeps_the_old_form(checker: Checker) -> None:
    code = """\
    import bpy
    def f(scene: bpy.types.Scene):
        scene.render.engine = 'BLENDER_EEVEE_NEXT'  # the quick one
    """
    file = migrated(checker, code, (4, 2))
    assert file.new == dedent("""\
    import bpy
    def f(scene: bpy.types.Scene):
        if bpy.app.version >= (5, 0, 0):
            scene.render.engine = 'BLENDER_EEVEE'
        else:
            scene.render.engine = 'BLENDER_EEVEE_NEXT'  # the quick one
    """)
    assert [change.guarded for change in file.changes] == [True]


def test_no_guard_where_the_older_version_has_the_new_form(checker: Checker) -> None:
    code = 'import bpy\nbpy.context.object.draw_type = "WIRE"\n'
    assert migrated(checker, code, (4, 2)).new == 'import bpy\nbpy.context.object.display_type = "WIRE"\n'


def test_what_the_target_still_takes_stays_for_a_version_that_lacks_the_new_form(checker: Checker) -> None:
    code = "import bpy\nprint(bpy.context.scene.sequence_editor.strips[0].frame_final_duration)\n"
    assert migrated(checker, code).new == code.replace("frame_final_duration", "duration")
    assert migrated(checker, code, (4, 5)).new == code


def test_a_setting_that_a_value_needs_now_is_set_first_where_it_is(checker: Checker) -> None:
    video = "settings.file_format = 'FFMPEG'\n"
    start = "import bpy\nsettings = bpy.context.scene.render.image_settings\n"
    kind = "settings.media_type = 'VIDEO'\n"
    assert migrated(checker, start + video).new == start + kind + video
    kept = migrated(checker, start + video, (4, 2))
    assert kept.new == f"{start}if bpy.app.version >= (5, 0, 0):\n    {kind}    {video}else:\n    {video}"
    assert kept.kept == kept.decisions == []


@pytest.mark.parametrize("keep", [(3, 6), (2, 79)])
def test_no_guard_gives_an_older_version_what_came_later(checker: Checker, keep: tuple[int, int]) -> None:
    code = "import bpy\nbpy.context.scene.render.engine = 'BLENDER_EEVEE_NEXT'\n"
    file = migrated(checker, code, keep)
    assert file.new == code.replace("_NEXT", "")
    ((version, finding),) = file.kept
    assert (version, finding.span.line) == (f"{keep[0]}.{keep[1]}", 2)
    assert "is there from Blender 4.2 on" in finding.message


def test_a_guard_for_one_version_does_not_hide_what_another_lacks(checker: Checker) -> None:
    code = "import bpy\nbpy.context.scene.render.engine = 'BLENDER_EEVEE_NEXT'\n"
    file = migrated(checker, code, (2, 79), (4, 2))
    assert "bpy.app.version >= (5, 0, 0)" in file.new
    assert [version for version, _ in file.kept] == ["2.79"]


def test_what_is_in_a_class_that_came_later_is_guarded_with_it(checker: Checker) -> None:
    made = 'bpy.context.scene.sequence_editor.{}.new_effect("a", "COLOR", 1, frame_start=1, {})\n'
    old, new = made.format("sequences", "frame_end=9"), made.format("strips", "length=8")
    file = migrated(checker, f"import bpy\n{old}", (4, 2))
    body = file.new.partition("if ")[2]
    assert [line.strip() for line in body.splitlines()[1:]] == [new.strip(), "else:", old.strip()]
    assert not file.kept


@pytest.mark.parametrize(
    ("line", "versions"),
    [
        ("tree.interface", ["3.6"]),
        ("if bpy.app.version >= (4, 0, 0): tree.interface", []),
        ("if hasattr(tree, 'interface'): tree.interface.new_socket('a')", []),
        ("if bpy.app.version_string > '4': tree.interface", []),
        ("tree.nodes", []),
        ("tree.nodes.new('ShaderNodeMixShader').inputs['Factor']", []),
        ("if bpy.data.brushes[0].gpencil_tool == 'DRAW': tree.nodes", []),
        ("bpy.context.scene.sequence_editor.sequences_all[0].frame_start", []),
        ("bpy.context.scene.sequence_editor.strips[0].frame_start", ["3.6", "4.2"]),
    ],
)
def test_names_that_a_kept_version_lacks_are_left_to_a_person(
    checker: Checker, line: str, versions: list[str]
) -> None:
    file = migrated(checker, f"import bpy\ntree = bpy.data.node_groups[0]\n{line}\n", (3, 6), (4, 2))
    assert [version for version, _ in file.kept] == versions


def test_errors_in_a_kept_version_are_those_of_the_whole_package(checker: Checker) -> None:
    files = {
        "addon/__init__.py": "import bpy\ndef register():\n    bpy.types.Scene.mine = bpy.props.IntProperty()\n",
        "addon/use.py": "import bpy\nbpy.context.scene.mine = 1\nbpy.context.scene.render.nothing\n",
    }
    kept = KeptVersion((checker.version[0], checker.version[1]), checker)
    use = files.pop("addon/use.py")
    (file,) = Migrator(checker, [kept]).migrate({"addon/use.py": use}, beside=files)
    assert [one.line for one in file.decisions] == [3]
    assert not file.kept


def test_members_are_no_older_than_their_class(checker: Checker) -> None:
    code = "import bpy\nbpy.context.scene.objects.link(bpy.context.object)\n"
    new = migrated(checker, code, (2, 79)).new
    assert "if bpy.app.version >= (2, 80, 0):" in new
    assert "    bpy.context.scene.objects.link(bpy.context.object)\n" in new


def test_a_product_that_is_refused_tells_how_old_a_script_is(checker: Checker) -> None:
    code = """\
    import bpy
    from mathutils import Vector
    place = bpy.context.object.matrix_world * Vector((1, 2, 3))
    height = Vector((1, 0, 0)) * Vector((0, 1, 0))
    """
    assert migrated(checker, code).new.count(" @ ") == 2
    new_code = dedent(code).replace("place = bpy.context.object.matrix_world * Vector((1, 2, 3))\n", "")
    assert migrated(checker, new_code).new == new_code


@pytest.mark.parametrize(
    ("line", "more"),
    [
        ("ob.data.use_auto_smooth = True", "ob.modifiers.new('S', 'SOLIDIFY')"),
        ("tex.color_space = 'NONE'", "tex.image = bpy.data.images[0]"),
        ("tex.color_space = 'OTHER'", ""),
        ("bsdf.inputs['Subsurface'].default_value = amount", ""),
        ("bpy.ops.transform.rotate(value=1, axis=(0, 0, -1))", ""),
        (
            "bpy.context.scene.sequence_editor.strips.new_effect('A', 'ADD', 1, 1, frame_end=9, input1=strip)",
            "",
        ),
    ],
)
def test_what_would_mean_something_else_is_left_to_a_person(checker: Checker, line: str, more: str) -> None:
    code = f"""\
import bpy
ob = bpy.context.object
nodes = bpy.data.materials[0].node_tree.nodes
tex, bsdf = nodes.new("ShaderNodeTexImage"), nodes["Principled BSDF"]
strip = bpy.context.scene.sequence_editor.strips[0]
amount = float(ob["amount"])
{line}
{more}
"""
    file = migrated(checker, code)
    assert file.new == code
    assert [one.line for one in file.decisions] == [7]


def test_neighbours_share_a_guard(checker: Checker) -> None:
    code = """\
    import bpy
    p = bpy.data.materials[0].node_tree.nodes.new("ShaderNodeBsdfPrincipled")
    p.inputs["Specular"].default_value = 1
    p.inputs["Subsurface"].default_value = 1
    """
    new = migrated(checker, code, (3, 6)).new
    assert new.count("bpy.app.version") == 1
    assert new.count("else:") == 1


def test_a_condition_gets_a_conditional_expression(checker: Checker) -> None:
    code = """\
    import bpy as B
    if B.context.scene.render.engine == 'BLENDER_EEVEE_NEXT':
        pass
    """
    new = migrated(checker, code, (4, 2)).new
    assert "== ('BLENDER_EEVEE' if B.app.version >= (5, 0, 0) else 'BLENDER_EEVEE_NEXT'):" in new


def test_no_second_guard_within_a_guard(checker: Checker) -> None:
    code = """\
    import bpy
    if bpy.app.version >= (5, 0, 0):
        bpy.context.scene.render.engine = 'BLENDER_EEVEE_NEXT'
    """
    assert migrated(checker, code, (4, 2)).new.count("bpy.app.version") == 1


@pytest.mark.parametrize(
    "line", ["ob.draw_type", "ob.matrix_world * ob.location", "bpy.context.scene.objects.link(ob)"]
)
def test_what_an_open_question_about_the_version_keeps_stays(checker: Checker, line: str) -> None:
    code = f"import bpy\nob = bpy.context.object\nif bpy.app.version_string < '2.80':\n    {line}\n"
    assert migrated(checker, code).new == code


def test_a_guard_that_cannot_be_written_is_left_to_a_person(checker: Checker) -> None:
    code = "from bpy import context\ncontext.scene.render.engine = 'BLENDER_EEVEE_NEXT'\n"
    file = migrated(checker, code, (4, 2))
    assert file.new == file.old
    assert [one.line for one in file.decisions] == [2]


def test_a_migrated_file_is_not_changed_again(checker: Checker) -> None:
    code = """\
    import bpy
    o = bpy.context.object
    for c in o.animation_data.action.fcurves:
        c.mute = o.select
    bpy.ops.object.shade_smooth({"object": o})
    """
    once = migrated(checker, code, (3, 6))
    assert once.changes
    again = migrated(checker, once.new, (3, 6))
    assert again.new == once.new


def test_lines_are_those_of_the_original(checker: Checker) -> None:
    code = """\
    import bpy
    o = bpy.context.object
    bpy.ops.object.shade_smooth({"object": o})
    for c in o.animation_data.action.fcurves: pass
    o.select = True
    o.layers[0] = True
    """
    file = migrated(checker, code)
    assert [change.line for change in file.changes] == [3, 4, 5]
    (decision,) = file.decisions
    assert decision.line == 6
    assert file.new.splitlines()[decision.now - 1] == "o.layers[0] = True"


def test_ends_of_lines_stay(checker: Checker) -> None:
    code = 'import bpy\r\nbpy.ops.object.shade_smooth({"object": bpy.context.object})\r\n'
    (file,) = Migrator(checker).migrate({"a.py": code})
    assert file.new.count("\r\n") == file.new.count("\n") == 3


def test_columns_count_letters_not_bytes(checker: Checker) -> None:
    code = 'import bpy\nname = "Größe 🎈"; bpy.context.object.draw_type = "WIRE"\n'
    assert migrated(checker, code).new.endswith('"Größe 🎈"; bpy.context.object.display_type = "WIRE"\n')


def test_types_flow_between_the_files_of_a_package(checker: Checker) -> None:
    files = {
        "addon/__init__.py": "from .tools import mark\nimport bpy\nmark(bpy.context.object)\n",
        "addon/tools.py": "def mark(ob):\n    ob.select = True\n",
    }
    first, second = Migrator(checker).migrate(files)
    assert not first.changes
    assert second.new == "def mark(ob):\n    ob.select_set(True)\n"


@pytest.mark.parametrize(
    "code",
    [
        "import bpy\nprint 'old'\nbpy.context.object.select = True\n",
        "import bpy\nbpy.context.object.select = \n",
        "\0",
        "",
        "import bpy\n" + "(" * 3000 + "bpy.context.object.select" + ")" * 3000 + "\n",
        "import bpy\nx = " + " * ".join(["bpy.context.object.matrix_world"] * 300) + "\n",
        "import bpy\nx = f'{bpy.context.object.select} {bpy.context.scene.cursor_location}'\n",
        "import bpy\nwith bpy.context.object as bpy.context.object.select: pass\n",
        "import bpy\nbpy.context.object.select: bool = True\ndel bpy.context.object.select\n",
        "import bpy\nbpy.ops.object.shade_smooth({**{}, 'object': 1}, *[], **{})\n",
        "import bpy; bpy.data.meshes[0].calc_normals(); x = 1\n",
        "import bpy\nif 1: bpy.data.meshes[0].calc_normals()\nelse: bpy.data.meshes[0].calc_normals()\n",
        "import bpy\n\x0cbpy.context.object.draw_type = '\\\nWIRE'\r",
    ],
)
@pytest.mark.parametrize("keep", [(), ((2, 79), (3, 6))])
def test_any_input_ends_in_text_that_python_reads(
    code: str, keep: tuple[tuple[int, int], ...], checker: Checker
) -> None:
    (file,) = Migrator(checker, [KeptVersion(version) for version in keep]).migrate({"a.py": code})
    if file.new != code:
        ast.parse(file.new)


def test_a_condition_on_the_version_stands_below_the_import_of_bpy(checker: Checker) -> None:
    keep = [KeptVersion((4, 2))]
    lines = ["import bpy", "from bpy.types import MetaSequence"]
    guarded = Migrator(checker, keep).migrate({"a.py": "\n".join(lines)})[0].new
    assert (
        "if bpy.app.version >= (4, 4, 0):\n    from bpy.types import MetaStrip as MetaSequence\n" in guarded
    )
    above = "\n".join(reversed(lines))
    (left,) = Migrator(checker, keep).migrate({"a.py": above})
    assert left.new == above
    assert [one.rule for one in left.decisions] == ["unknown-name"]
