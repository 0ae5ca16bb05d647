"""What panels ask before they let a setting be changed: each way to write it, and what of it may be told."""

from __future__ import annotations

import time
from contextlib import closing
from textwrap import dedent, indent
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.analysis import analyse
from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.panels.conditions import panel_conditions
from kb_build.panels.drawn_places import places_in
from kb_build.panels.gating import from_rows, gatings_in, merged, settled, to_rows

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

T = "bpy.types."
DOF = "CameraDOFSettings"
DISTANCE = f"{DOF}.focus_distance"
GREYED = "greyed unless use_dof on"
HIDDEN = "hidden unless use_dof on"


@pytest.fixture(scope="module")
def symbols(base: Path) -> Iterator[BaseSymbols]:
    with closing(BaseSymbols(base)) as found:
        yield found


def asked(symbols: BaseSymbols, *scripts: str, of: str = DISTANCE) -> list[str]:
    """What the panels of scripts ask before they let a property be set, a line each clause."""
    api = Api(symbols)
    parts = [gatings_in(places_in(analyse(code, api, (5, 1, 0)), symbols), symbols) for code in scripts]
    clauses: dict[int, list[str]] = {}
    hides: dict[int, bool] = {}
    for row in panel_conditions(settled(merged(parts), symbols), symbols):
        if row.path == T + of:
            owner, _, name = row.gate.removeprefix(T).rpartition(".")
            gate = name if owner == of.partition(".")[0] else f"{owner}.{name}"
            clauses.setdefault(row.clause, []).append(f"{gate} {row.test}")
            hides[row.clause] = row.otherwise == "hidden"
    return sorted(
        f"{'hidden' if hides[number] else 'greyed'} unless {' or '.join(tests)}"
        for number, tests in clauses.items()
    )


def panel(body: str, before: str = "", within: str = "") -> str:
    """A panel that draws a camera's depth of field."""
    return (
        f"import bpy\n{dedent(before)}\n"
        f"class DATA_PT_dof(bpy.types.Panel):\n{indent(dedent(within), '    ')}\n"
        "    def draw(self, context):\n"
        "        layout = self.layout\n"
        "        dof = context.camera.dof\n"
        f"{indent(dedent(body), '        ')}\n"
    )


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        # A layout greys out what is in it, whenever it is told to, and what is in layouts within.
        ("""
         layout.active = dof.use_dof
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         layout.prop(dof, "focus_distance")
         layout.active = dof.use_dof
         """, [GREYED]),
        ("""
         layout.enabled = dof.use_dof
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         sub = layout.column().row(align=True)
         sub.prop(dof, "focus_distance")
         layout.active = dof.use_dof
         """, [GREYED]),
        ("""
         col = layout.column()
         sub = col.row()
         sub.active = dof.use_dof
         col.prop(dof, "focus_distance")
         """, []),
        ("""
         col = layout.column()
         col.active = dof.use_dof
         layout.row().prop(dof, "focus_distance")
         """, []),
        ("""
         layout.active = dof.use_dof
         layout.active = True
         layout.prop(dof, "focus_distance")
         """, []),
        ("""
         header, body = layout.panel("dof")
         body.active = dof.use_dof
         body.prop(dof, "focus_distance")
         """, [GREYED]),
        # Of two layouts by one name, nobody knows which is meant where.
        ("""
         col = layout.column()
         other = layout.column() if dof.focus_object else col
         col.active = dof.use_dof
         other.active = True
         col.prop(dof, "focus_distance")
         """, []),
        ("""
         if dof.use_dof:
             sub = layout.column()
         else:
             sub = layout.row()
         sub.active = dof.use_dof
         sub.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         if not dof.use_dof:
             layout.active = False
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         is_on = dof.use_dof
         col = layout.column()
         col.active = is_on
         col.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         col = layout.column()
         col.active = is_on(dof)
         col.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         col = layout.column()
         col.active = is_on_at_times(dof, context)
         col.prop(dof, "focus_distance")
         """, []),
        # Branches, early returns and loops.
        ("""
         if dof.use_dof:
             layout.prop(dof, "focus_distance")
         """, [HIDDEN]),
        ("""
         if dof.use_dof is False:
             return
         layout.prop(dof, "focus_distance")
         """, [HIDDEN]),
        ("""
         if not dof.use_dof:
             layout.label(text="off")
         else:
             layout.prop(dof, "focus_distance")
         """, [HIDDEN]),
        ("""
         if dof.use_dof:
             layout.prop(dof, "aperture_fstop")
         layout.prop(dof, "focus_distance")
         """, []),
        ("""
         for n in range(3):
             if not dof.use_dof:
                 continue
             layout.prop(dof, "focus_distance")
         """, [HIDDEN]),
        ("""
         for n in range(3):
             row = layout.row()
             row.active = dof.use_dof
             if n == 1:
                 row.active = True
                 continue
             row.prop(dof, "focus_distance")
         """, []),
        ("""
         row = layout.row()
         for n in range(3):
             row.active = n > 1
         row.prop(dof, "focus_distance")
         """, []),
        ("""
         try:
             layout.active = dof.use_dof
         except AttributeError:
             layout.active = True
         layout.prop(dof, "focus_distance")
         """, []),
        ("""
         with layout as other:
             layout.active = dof.use_dof
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        # Conditions.
        ("""
         layout.active = dof.use_dof and dof.focus_object is None
         layout.prop(dof, "focus_distance")
         """, ["greyed unless focus_object not set", GREYED]),
        ("""
         layout.active = dof.use_dof or dof.aperture_ratio > 1
         layout.prop(dof, "focus_distance")
         """, ["greyed unless aperture_ratio > 1 or use_dof on"]),
        ("""
         layout.active = dof.use_dof or len(bpy.data.objects) > 3
         layout.prop(dof, "focus_distance")
         """, []),
        ("""
         layout.active = dof.use_dof and len(bpy.data.objects) > 3 and context.mode == 'OBJECT'
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         layout.active = not (not dof.use_dof or dof.no_such_setting)
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        ("""
         layout.active = bool(dof.use_dof) if context.camera.show_limits else dof.use_dof is True
         layout.prop(dof, "focus_distance")
         """, [GREYED]),
        # Places together: what holds at all of them.
        ("""
         if dof.use_dof:
             layout.prop(dof, "focus_distance")
         layout.column().prop(dof, "focus_distance")
         """, []),
        ("""
         if dof.focus_object:
             col = layout.column()
             col.active = dof.use_dof
             col.prop(dof, "focus_distance")
         else:
             row = layout.row()
             row.enabled = dof.use_dof and dof.aperture_blades > 0
             row.prop(dof, "focus_distance")
         """, ["greyed unless aperture_blades > 0 or focus_object set", GREYED]),
        # Another object of the same class says nothing of this one.
        ("""
         other = bpy.data.cameras[0].dof
         layout.active = other.use_dof
         layout.prop(dof, "focus_distance")
         """, []),
        # One of another class is told by its class.
        ("""
         layout.active = context.camera.show_limits
         layout.prop(dof, "focus_distance")
         """, ["greyed unless Camera.show_limits on"]),
        # What only another class's setting hides may be shown elsewhere, by what is not read.
        ("""
         if context.scene.use_gravity:
             layout.prop(dof, "focus_distance")
         """, []),
    ],
)  # fmt: skip
def test_a_place_in_a_panel(symbols: BaseSymbols, body: str, expected: list[str]) -> None:
    functions = """
        def is_on(settings):
            return settings.use_dof

        def is_on_at_times(settings, context):
            if context.mode == 'OBJECT':
                return True
            return settings.use_dof
    """
    assert asked(symbols, panel(body, functions)) == expected


@pytest.mark.parametrize(
    ("body", "of", "expected"),
    [
        ("if camera.type == 'ORTHO':\n    layout.prop(camera, 'ortho_scale')", "Camera.ortho_scale",
         ["hidden unless type 'ORTHO'"]),
        ("if camera.type in {'ORTHO', 'PANO'}:\n    layout.prop(camera, 'ortho_scale')", "Camera.ortho_scale",
         ["hidden unless type 'ORTHO' or 'PANO'"]),
        ("if camera.type not in ('ORTHO', 'PANO'):\n    layout.prop(camera, 'lens')", "Camera.lens",
         ["hidden unless type none of 'ORTHO', 'PANO'"]),
        ("if camera.type == 'PERSP':\n    pass\nelif camera.type == 'ORTHO':\n"
         "    layout.prop(camera, 'ortho_scale')", "Camera.ortho_scale", ["hidden unless type 'ORTHO'"]),
        ("if camera.type == 'PERSP':\n    layout.prop(camera, 'lens')\n"
         "if camera.type == 'PANO':\n    layout.prop(camera, 'lens')", "Camera.lens",
         ["hidden unless type 'PANO' or 'PERSP'"]),
        ("if camera.type == 'PERSP':\n    layout.prop(camera, 'lens')\n"
         "elif camera.type != 'PERSP':\n    layout.prop(camera, 'lens')", "Camera.lens", []),
        ("layout.active = camera.name != 'X'\nlayout.prop(camera, 'lens')", "Camera.lens", []),
        # Whose part it is may decide whether it is shown at all; a mode that makes the part is told with the part.
        ("paint = context.object.modifiers['Dynamic Paint']\nif paint.ui_type == 'BRUSH':\n"
         "    layout.prop(paint.brush_settings, 'paint_color')", "DynamicPaintBrushSettings.paint_color",
         ["hidden unless DynamicPaintModifier.ui_type 'BRUSH'"]),
        ("fluid = context.object.modifiers['Fluid']\nif fluid.fluid_type == 'DOMAIN':\n"
         "    layout.prop(fluid.domain_settings, 'alpha')", "FluidDomainSettings.alpha", []),
        # The class follows from the type: that is no condition.
        ("light = context.light\nif light.type == 'SUN':\n    layout.prop(light, 'angle')", "SunLight.angle", []),
        # What leads to an object is no condition on it; what Blender itself sets is none to turn on.
        ("scene = context.scene\nif scene.camera:\n    layout.prop(scene.camera, 'name')", "Object.name", []),
        ("cache = context.cloth.point_cache\nlayout.enabled = not cache.is_baked\n"
         "layout.prop(cache, 'frame_start')", "PointCache.frame_start", []),
        # A modifier's panel is not written in Python.
        ("md = context.object.modifiers.new('x', 'BEVEL')\nlayout.active = md.use_clamp_overlap\n"
         "layout.prop(md, 'width')", "BevelModifier.width", []),
    ],
)  # fmt: skip
def test_what_is_asked_of_other_types(symbols: BaseSymbols, body: str, of: str, expected: list[str]) -> None:
    assert asked(symbols, panel(f"camera = context.camera\n{body}"), of=of) == expected


def test_a_poll_hides_the_panel_and_those_within(symbols: BaseSymbols) -> None:
    poll = """
        @classmethod
        def poll(cls, context):
            if not context.camera:
                return False
            return context.camera.dof.use_dof
    """
    shows = "layout.prop(dof, 'focus_distance')"
    assert asked(symbols, panel(shows, within=poll)) == [HIDDEN]
    mixin = f"class Depth:\n{indent(dedent(poll), '    ')}"
    assert asked(symbols, panel(shows, before=mixin).replace("_dof(", "_dof(Depth, ")) == [HIDDEN]
    outer = f"class OUTER(bpy.types.Panel):\n{indent(dedent(poll), '    ')}"
    assert asked(symbols, panel(shows, before=outer, within="bl_parent_id = 'OUTER'")) == [HIDDEN]
    # A class that others derive from is drawn under theirs.
    derived = panel(shows, within=poll) + "class Other(DATA_PT_dof):\n    pass\n"
    assert asked(symbols, derived) == []


def test_a_greyed_panel_does_not_grey_those_within(symbols: BaseSymbols) -> None:
    outer = panel("layout.active = dof.use_dof").replace("DATA_PT_dof", "OUTER")
    inner = panel("layout.prop(dof, 'focus_distance')", before=outer, within="bl_parent_id = 'OUTER'")
    assert asked(symbols, inner) == []


def test_what_another_script_shows_without_condition_is_not_told(symbols: BaseSymbols) -> None:
    greyed = panel("layout.active = dof.use_dof\nlayout.prop(dof, 'focus_distance')")
    plain = panel("layout.prop(dof, 'focus_distance')")
    assert asked(symbols, greyed) == [GREYED]
    assert asked(symbols, greyed, plain) == asked(symbols, plain, greyed) == []
    searched = panel("layout.template_ID(dof, 'focus_object')")
    both = panel("layout.active = dof.use_dof\nlayout.prop(dof, 'focus_object')")
    assert asked(symbols, both, of=f"{DOF}.focus_object") == [GREYED]
    assert asked(symbols, both, searched, of=f"{DOF}.focus_object") == []


def test_what_an_unknown_object_shows_counts_for_every_class_with_that_name(symbols: BaseSymbols) -> None:
    greyed = panel("layout.active = dof.use_dof\nlayout.prop(dof, 'focus_distance')")
    helper = (
        "def draw_it(self, thing):\n    layout = self.layout\n{}    layout.prop(thing, 'focus_distance')\n"
    )
    assert asked(symbols, greyed, helper.format("")) == []
    # If it is of this class, the same holds there.
    assert asked(symbols, greyed, helper.format("    layout.active = thing.use_dof\n")) == [GREYED]
    # A class of the script's own has properties of its own.
    own = "import bpy\nclass Own(bpy.types.Operator):\n    def draw(self, context):\n"
    assert asked(symbols, greyed, own + "        self.layout.prop(self, 'focus_distance')\n") == [GREYED]


def test_what_may_be_another_class_is_not_told_of_each(symbols: BaseSymbols) -> None:
    # A panel of one editor: the other editors that have such a setting show it elsewhere, or not at all.
    code = panel(
        "view = context.space_data\nlayout.active = view.show_gizmo\nlayout.prop(view, 'show_gizmo_context')"
    )
    for space in ("SpaceView3D", "SpaceSequenceEditor"):
        assert asked(symbols, code, of=f"{space}.show_gizmo_context") == []
    # An edited bone is asked for its own segments, not for those of what may be a bone.
    bones = """
        bone = context.bone or context.edit_bone
        other = context.edit_bone
        layout.active = bone.bbone_segments > 1
        layout.prop(other, "bbone_easein")
    """
    assert asked(symbols, panel(bones), of="EditBone.bbone_easein") == []
    own = (
        "bone = context.edit_bone\nlayout.active = bone.bbone_segments > 1\nlayout.prop(bone, 'bbone_easein')"
    )
    assert asked(symbols, panel(own), of="EditBone.bbone_easein") == ["greyed unless bbone_segments > 1"]


@pytest.mark.parametrize(
    ("before", "expected"),
    [
        ("mode = ob.rotation_mode", ["hidden unless rotation_mode 'QUATERNION'"]),
        # By then it may be another thing's, or another value.
        ("mode = ob.rotation_mode\nob = context.object.parent", []),
        ("mode = ob.rotation_mode\nif ob.parent:\n    mode = 'QUATERNION'", []),
    ],
)
def test_a_name_of_a_choice_is_read_as_that(symbols: BaseSymbols, before: str, expected: list[str]) -> None:
    body = (
        f"ob = context.object\n{before}\nif mode == 'QUATERNION':\n    layout.prop(ob, 'rotation_quaternion')"
    )
    assert asked(symbols, panel(body), of="Object.rotation_quaternion") == expected


@pytest.mark.parametrize(
    ("of", "expected"),
    [
        ("LimitLocationConstraint.min_x", ["greyed unless use_min_x on"]),
        ("LimitScaleConstraint.min_x", ["greyed unless use_min_x on"]),
        ("LimitRotationConstraint.min_x", ["greyed unless use_limit_x on"]),
    ],
)
def test_what_has_not_all_that_is_asked_is_not_shown(
    symbols: BaseSymbols, of: str, expected: list[str]
) -> None:
    limits = (
        "con = context.object.constraints[0]\nsub = layout.row()\nsub.active = con.{}\nsub.prop(con, 'min_x')"
    )
    assert (
        asked(symbols, *(panel(limits.format(name)) for name in ("use_min_x", "use_limit_x")), of=of)
        == expected
    )
    perhaps = (
        "con = context.object.constraints[0]\nif con.mute or con.use_limit_x:\n    layout.prop(con, 'min_x')"
    )
    assert asked(symbols, panel(perhaps), of=of) == []


def offered(symbols: BaseSymbols, *bodies: str, operator: str = "fluid.bake_all") -> list[str]:
    """What panels that draw a fluid's domain ask before they offer an operator."""
    before = "domain = context.fluid.domain_settings\n"
    codes = [panel(before + dedent(body)) for body in bodies]
    api = Api(symbols)
    parts = [gatings_in(places_in(analyse(code, api, (5, 1, 0)), symbols), symbols) for code in codes]
    rows = panel_conditions(settled(merged(parts), symbols), symbols)
    return sorted(
        f"{row.otherwise} unless {row.gate.removeprefix(T)} {row.test}"
        for row in rows
        if row.path == f"bpy.ops.{operator}"
    )


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("layout.operator('fluid.bake_all')", []),
        ("""
         if domain.cache_type == 'ALL':
             layout.operator("fluid.bake_all", text="Resume")
         """, ["hidden unless FluidDomainSettings.cache_type 'ALL'"]),
        ("""
         layout.enabled = domain.use_mesh
         layout.operator(operator="fluid.bake_all")
         """, ["greyed unless FluidDomainSettings.use_mesh on"]),
        ("""
         for name in ("fluid.bake_all", "fluid.free_all"):
             if domain.use_mesh:
                 layout.operator(name)
         """, ["hidden unless FluidDomainSettings.use_mesh on"]),
        ("""
         if domain.use_mesh:
             layout.operator(context.scene.name)
         """, []),
    ],
)  # fmt: skip
def test_the_button_of_an_operator(symbols: BaseSymbols, body: str, expected: list[str]) -> None:
    assert offered(symbols, body) == expected
    assert offered(symbols, body, "layout.operator('fluid.bake_all')") == []


def test_an_operator_that_its_arguments_decide_says_nothing(symbols: BaseSymbols) -> None:
    body = "if domain.use_mesh:\n    layout.operator('{}')"
    assert offered(symbols, body.format("wm.context_toggle"), operator="wm.context_toggle") == []
    assert offered(symbols, body.format("fluid.bake_mesh"), operator="fluid.bake_mesh") != []


@pytest.mark.parametrize(
    ("kind", "call"),
    [
        ("@staticmethod\ndef is_on(context):", "Base.is_on(context)"),
        ("@staticmethod\ndef is_on(context):", "cls.is_on(context)"),
        ("@classmethod\ndef is_on(cls, context):", "Base.is_on(context)"),
        ("@classmethod\ndef is_on(cls, context):", "cls.is_on(context)"),
        ("def is_on(self, context):", "Base.is_on(None, context)"),
    ],
)
def test_a_poll_asks_a_function_of_a_class(symbols: BaseSymbols, kind: str, call: str) -> None:
    base = f"class Base:\n{indent(kind, '    ')}\n        return context.camera.dof.use_dof\n"
    code = panel(
        "layout.prop(dof, 'focus_distance')",
        base,
        f"@classmethod\ndef poll(cls, context):\n    return {call}",
    )
    derived = code.replace("DATA_PT_dof(bpy.types.Panel)", "DATA_PT_dof(Base, bpy.types.Panel)")
    assert asked(symbols, derived) == [HIDDEN]


SPRAY, FOAM, BUBBLE = (f"domain.use_{name}_particles" for name in ("spray", "foam", "bubble"))


@pytest.mark.parametrize(
    ("condition", "count"),
    [
        (f"{SPRAY} or {FOAM} or {BUBBLE}", 3),
        (f"{SPRAY} or {FOAM} or {BUBBLE} or domain.use_mesh", 4),
        (f"{SPRAY} or {FOAM} or not {BUBBLE}", 0),  # only of what is to be on
        (f"{SPRAY} or {FOAM} or {BUBBLE} or context.scene.get('else')", 0),
    ],
)
def test_of_several_switches_one_must_be_on(symbols: BaseSymbols, condition: str, count: int) -> None:
    body = f"layout.active = {condition}\nlayout.operator('fluid.bake_all')"
    assert len(offered(symbols, body)) == count
    assert len(offered(symbols, body, body)) == count


def test_what_is_kept_between_builds_is_read_back(symbols: BaseSymbols) -> None:
    code = panel("layout.active = dof.use_dof or dof.aperture_ratio > 1\nlayout.prop(dof, 'focus_distance')")
    found = gatings_in(places_in(analyse(code, Api(symbols), (5, 1, 0)), symbols), symbols)
    assert found
    assert {path: from_rows(to_rows(gating)) for path, gating in found.items()} == found


def test_branches_without_end_take_no_time(symbols: BaseSymbols) -> None:
    body = ["is_on = dof.use_dof"]
    for number in range(60):
        body += [
            f"if context.scene.get('{number}'):",
            f"    if context.scene.get('x{number}'):",
            "        return",
        ]
        body += [
            f"if context.scene.get('y{number}'):",
            f"    is_on = is_on and context.scene.get('z{number}')",
        ]
        body += [f"if context.scene.get('y{number}'):", "    layout.active = is_on"]
    body += ["row = layout.row()", "row.active = dof.use_dof", "row.prop(dof, 'focus_distance')"]
    began = time.process_time()
    assert asked(symbols, panel("\n".join(body))) == [GREYED]
    assert time.process_time() - began < 5
    deep = "layout.active = " + "(" * 80 + "dof.use_dof" + ")" * 80 + " and not" * 900 + " dof.use_dof"
    assert isinstance(asked(symbols, panel(f"{deep}\nlayout.prop(dof, 'focus_distance')")), list)


def test_a_script_that_cannot_be_read_has_no_panels(symbols: BaseSymbols) -> None:
    assert places_in(analyse("print 'x'", Api(symbols), ()), symbols) == []
