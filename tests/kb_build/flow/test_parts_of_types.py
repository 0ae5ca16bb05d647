"""What lists, dictionaries and objects hold is as sure as they are, and belongs to one call as they do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from flow_reading import read, unknown

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api

_EACH = "import bpy\ndef use(things):\n    for one in things:\n        one.nothing\n"
_SHOWN = "import bpy\ndef show({}):\n    for kind in kinds:\n        bpy.context.object.display_type = kind\n"


def refused(api: Api, code: str) -> set[str]:
    """The texts that are surely not among the values of what they are given to."""
    analysis = read(api, code)
    rows = [*analysis.resolutions.values(), *analysis.carried]
    return {row.value for row in rows if row.kind == "value" and row.missing and row.sure}


@pytest.mark.parametrize(
    ("holder", "owner"),
    [
        ("[bpy.context.object]", "Object"),
        ("{bpy.context.object}", "Object"),
        ("{bpy.context.object: 1}", "Object"),
        ("{bpy.types.Mesh: 1}", "Mesh"),
    ],
)
def test_what_some_calls_pass_is_not_sure_wherever_it_is_held(api: Api, holder: str, owner: str) -> None:
    assert unknown(api, f"{_EACH}use({holder})") == {(owner, "nothing")}
    assert unknown(api, f"{_EACH}use({holder})\nuse(unknown())") == set()


def test_the_data_of_an_object_that_some_calls_pass_is_not_sure(api: Api) -> None:
    code = "import bpy\nmesh = bpy.data.meshes.new('x')\ndef use(ob):\n    ob.data.nothing\n"
    code += "use(bpy.data.objects.new('x', mesh))\n"
    assert unknown(api, code) == {("Mesh", "nothing")}
    assert unknown(api, code + "use(unknown())") == set()


@pytest.mark.parametrize("kinds", ["['NO']", "{'NO': 1}", "{'NO': 1, 'NEITHER': 2}"])
def test_the_texts_of_a_default_are_not_all_that_may_be_given(api: Api, kinds: str) -> None:
    assert "NO" in refused(api, _SHOWN.format("kinds") + f"show({kinds})\n")
    assert not refused(api, _SHOWN.format(f"kinds={kinds}") + "show(unknown())\n")


def test_keys_beside_others_that_are_not_known_are_texts_of_a_call(api: Api) -> None:
    assert refused(api, _SHOWN.format("kinds") + "show({**others, 'NO': 1})\n") == {"NO"}


@pytest.mark.parametrize(
    ("made", "item"), [("({}, unknown())", "[0]"), ("{{'light': {}, 'else': unknown()}}", "['light']")]
)
def test_each_call_has_its_own_of_what_it_returns_in_others(api: Api, made: str, item: str) -> None:
    body = made.format("bpy.data.lights.new('x', kind)")
    code = f"import bpy\ndef make(kind):\n    return {body}\nmake('SUN'){item}.spot_size\nmake('SPOT'){item}.spot_size"
    rows = [row for row in read(api, code).resolutions.values() if row.value == "spot_size"]
    assert [(row.symbols, row.missing) for row in rows] == [
        ((), ("bpy.types.SunLight",)),
        (("bpy.types.SpotLight.spot_size",), ()),
    ]


@pytest.mark.parametrize(("flags", "doubted"), [("({}, 1)", True), ("{{'new': {}, 'else': 1}}", False)])
def test_a_dictionary_tells_of_this_blender_only_where_it_is_read(
    api: Api, flags: str, *, doubted: bool
) -> None:
    code = f"import bpy\nflags = {flags.format('bpy.app.version > unknown()')}\n"
    code += "if flags == others:\n    bpy.context.object.nothing"
    row = next(row for row in read(api, code).resolutions.values() if row.value == "nothing")
    assert row.guarded is doubted
