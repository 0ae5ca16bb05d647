"""Types flow between the files of a package, and what one registers is known to the others."""

from __future__ import annotations

import ast
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from flow_reading import TYPES

from kb_build.flow.analysis import analyse_files
from kb_build.flow.values.types import Instance, members

if TYPE_CHECKING:
    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api


def read(api: Api, files: dict[str, str]) -> dict[str, Analysis]:
    return analyse_files({path: dedent(code) for path, code in files.items()}, api, (5, 1, 0))


def last_types(api: Api, files: dict[str, str], path: str) -> set[str]:
    """The classes of the expression that a file's module, or its last function, ends with."""
    analysis = read(api, files)[path]
    assert analysis.tree is not None
    last = analysis.tree.body[-1]
    while isinstance(last, (ast.FunctionDef, ast.ClassDef)):
        last = last.body[-1]
    assert isinstance(last, ast.Expr)
    return {
        member.cls.removeprefix(TYPES) if isinstance(member, Instance) else type(member).__name__
        for member in members(analysis.types[last.value])
    }


def unknown(api: Api, files: dict[str, str]) -> set[tuple[str, str]]:
    return {
        (row.missing[0].removeprefix(TYPES), row.value)
        for analysis in read(api, files).values()
        for row in analysis.resolutions.values()
        if row.missing and not row.symbols and row.sure and not row.guarded
    }


UTILS = """
    import bpy
    SIZE = 2
    def active_cloth(ob):
        return ob.modifiers.new("x", 'CLOTH')
    class Helper:
        def camera(self):
            return bpy.data.cameras.new("x")
"""


@pytest.mark.parametrize(
    "imports",
    [
        "from .utils import active_cloth, Helper",
        "from . import utils\nactive_cloth, Helper = utils.active_cloth, utils.Helper",
        "import addon.utils\nactive_cloth, Helper = addon.utils.active_cloth, addon.utils.Helper",
        "import addon.utils as u\nactive_cloth, Helper = u.active_cloth, u.Helper",
        "from addon.utils import active_cloth, Helper",
        "from .utils import *",
        "from .deep.inner import active_cloth, Helper",
    ],
)
def test_functions_and_classes_of_another_file(api: Api, imports: str) -> None:
    files = {
        "addon/utils.py": UTILS,
        "addon/deep/inner.py": "from ..utils import *",
        "addon/__init__.py": "from . import ops, utils",
    }
    for code, cls in (
        ("active_cloth(bpy.context.object).settings", "ClothSettings"),
        ("Helper().camera()", "Camera"),
    ):
        ops = f"import bpy\n{imports}\n{code}"
        assert last_types(api, {**files, "addon/ops.py": ops}, "addon/ops.py") == {cls}


def test_a_call_tells_a_function_of_another_file_what_it_gets(api: Api) -> None:
    files = {
        "addon/__init__.py": "import bpy\nfrom .b import show\nshow(bpy.data.cameras.new('x'))",
        "addon/b.py": "def show(thing):\n    thing.dof",
    }
    assert last_types(api, files, "addon/b.py") == {"CameraDOFSettings"}


def test_files_may_import_each_other(api: Api) -> None:
    files = {
        "addon/a.py": "import bpy\nfrom . import b\ndef scene():\n    return bpy.context.scene\n",
        "addon/b.py": "from . import a\ndef use():\n    a.scene().render",
    }
    assert last_types(api, files, "addon/b.py") == {"RenderSettings"}
    files["addon/a.py"], files["addon/b.py"] = "from .b import f\nf", "from .a import f\nf"
    assert all(analysis.complete for analysis in read(api, files).values())


CIRCLE = {
    "addon/inputs.py": """
        def remember(caches):
            print([inputs(cache) for cache in caches])
        def changed(cache):
            return inputs(cache)
        def inputs(cache):
            owner, = (cache.owner,)
            return seed(owner, cache)
        def seed(owner, cache):
            system = cache.holder
            return system.seed
    """,
    "addon/cache.py": """
        from . import inputs
        class Cache:
            def __init__(self, owner, holder):
                self.owner, self.holder = owner, holder
            def changed(self):
                return inputs.changed(self)
        def find(scene):
            return [Cache(scene, scene.rigidbody_world)]
        def of_modifier(obj, modifier):
            yield Cache(obj, modifier.particle_system)
    """,
    "addon/steps.py": """
        from . import cache
        class Steps:
            def __init__(self):
                self.held = [one for one in waiting()]
        def waiting():
            return [one for one in cache.find()]
    """,
}


def test_what_turns_out_to_be_more_is_read_again(api: Api) -> None:
    """An attribute is known by one of the two things that the class is made with when it is first read."""
    assert unknown(api, CIRCLE) == set()


def test_what_is_not_read_again_denies_nothing(api: Api) -> None:
    """A module is read once, before the functions of those that it uses."""
    files = {
        "addon/__init__.py": """
            import bpy
            class Kept:
                def __init__(self):
                    self.thing = bpy.context.scene
                def replace(self, thing):
                    self.thing = bpy.context.object
            print(Kept().thing.particle_systems, Kept().thing.nothing)
        """
    }
    assert unknown(api, files) == set()
    files["addon/__init__.py"] = files["addon/__init__.py"].replace("bpy.context.object", "thing.id_data")
    assert unknown(api, files) == set()
    files["addon/__init__.py"] = files["addon/__init__.py"].replace("thing.id_data", "bpy.context.scene")
    assert unknown(api, files) == {("Scene", "particle_systems"), ("Scene", "nothing")}


def test_a_long_chain_of_imports_ends(api: Api) -> None:
    files = {f"addon/m{n}.py": f"from .m{n + 1} import x" for n in range(400)}
    assert all(analysis.complete for analysis in read(api, files).values())


def test_a_registered_group_of_another_file(api: Api) -> None:
    files = {
        "addon/__init__.py": """
            import bpy
            from .props import Settings
            def register():
                bpy.types.Scene.my_settings = bpy.props.PointerProperty(type=Settings)
        """,
        "addon/props.py": """
            import bpy
            class Settings(bpy.types.PropertyGroup):
                target: bpy.props.PointerProperty(type=bpy.types.Object)
        """,
        "addon/ui.py": "import bpy\ndef draw(self, context):\n    context.scene.my_settings.target",
    }
    assert last_types(api, files, "addon/ui.py") == {"Object"}
    files["addon/ui.py"] = "import bpy\nbpy.context.scene.my_setings"
    assert unknown(api, files) == {("Scene", "my_setings")}


@pytest.mark.parametrize(
    "registers",
    [
        "for cls in (bpy.types.Scene, bpy.types.Object):\n    cls.mine = bpy.props.IntProperty()",
        "setattr(bpy.types.Scene, 'mine', bpy.props.IntProperty())",
        "class P(bpy.types.PropertyGroup):\n    @classmethod\n    def register(cls):\n"
        "        cls.type.mine = bpy.props.IntProperty()",
        "class P(bpy.types.PropertyGroup):\n    def register():\n        bpy.types.Scene.mine = 1",
    ],
)
def test_ways_to_register_a_property(api: Api, registers: str) -> None:
    registered = {name for _, name in read(api, {"a.py": f"import bpy\n{registers}"})["a.py"].registered}
    assert registered == {"mine"}


def test_classes_of_the_package_are_found_below_bpy_types(api: Api) -> None:
    files = {
        "addon/a.py": """
            import bpy
            class Parameters(bpy.types.PropertyGroup):
                target: bpy.props.PointerProperty(type=bpy.types.Object)
            class OBJECT_OT_mine(bpy.types.Operator):
                pass
            class Other(bpy.types.Operator):
                bl_idname = "mesh.theirs"
        """,
        "addon/b.py": "import bpy\ndef f(p: bpy.types.Parameters):\n    p.target",
    }
    assert last_types(api, files, "addon/b.py") == {"Object"}
    own = read(api, files)["addon/a.py"]
    assert {"bpy.ops.object.mine", "bpy.ops.mesh.theirs"} <= own.own_operators
    assert {"Parameters", "OBJECT_OT_mine", "MESH_OT_theirs"} <= own.own_types


def test_an_annotation_that_calls_contradict_is_not_believed(api: Api) -> None:
    code = """
        import bpy
        def f(camera: bpy.types.Camera):
            camera.matrix_world
        f(bpy.context.object)
    """
    assert unknown(api, {"a.py": code}) == set()
    assert unknown(api, {"a.py": code.replace("context.object", "data.cameras[0]")}) == {
        ("Camera", "matrix_world")
    }
