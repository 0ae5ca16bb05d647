"""Texts that names, calls and loops bring: refused where they surely come, as Blender does, and nowhere else."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

AROUND = """
import bpy
scene = bpy.context.scene
tree = bpy.data.materials.new("m").node_tree
bsdf = tree.nodes["Principled BSDF"]
ob = bpy.data.objects.new("a", bpy.data.meshes.new("a"))
engines = [item.identifier for item in scene.render.bl_rna.properties["engine"].enum_items]
def use(engine):
    scene.render.engine = engine
def add(kind, label="", x=0):
    n = tree.nodes.new(kind)
    if label:
        n.label = label
    n.location.x = x
    return n
"""
ENGINE = "bpy.types.RenderSettings.engine:BLENDER_EEVEE_NEXT"
MUSGRAVE = "bpy.types.ShaderNodeTexMusgrave"
SPECULAR = 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular"]'
# Lines → the symbols of what is found.
REFUSED = {
    "a name": ("engine = 'BLENDER_EEVEE_NEXT'\nscene.render.engine = engine", [ENGINE]),
    "a name of the module, in a function": (
        """
        ENGINE = 'BLENDER_EEVEE_NEXT'
        def setup():
            scene.render.engine = ENGINE
        setup()
        """,
        [ENGINE],
    ),
    "a name of a class of nodes": ("kind = 'ShaderNodeTexMusgrave'\ntree.nodes.new(kind)", [MUSGRAVE]),
    "an item of a dictionary": (
        "chosen = {'engine': 'BLENDER_EEVEE_NEXT'}\nscene.render.engine = chosen['engine']",
        [ENGINE],
    ),
    "what a call passes": ("use('CYCLES')\nuse('BLENDER_EEVEE_NEXT')", [ENGINE]),
    "what a call passes by its name": ("add(x=1, kind='ShaderNodeTexMusgrave')", [MUSGRAVE]),
    "what a call passes on": (
        """
        def old(x):
            return add('ShaderNodeTexMusgrave', "Old", x)
        old(1)
        """,
        [MUSGRAVE],
    ),
    "what a call of a method passes": (
        """
        class Builder:
            def __init__(self, tree):
                self.tree = tree
            def add(self, kind):
                return self.tree.nodes.new(kind)
        builder = Builder(tree)
        builder.add('ShaderNodeMix')
        builder.add('ShaderNodeTexMusgrave')
        """,
        [MUSGRAVE],
    ),
    "what is passed to a function in a function": (
        """
        def build(nodes):
            def one(kind):
                return nodes.new(kind)
            one('ShaderNodeMix')
            one('ShaderNodeTexMusgrave')
        build(tree.nodes)
        """,
        [MUSGRAVE],
    ),
    "a default": (
        """
        def setup(name, engine='BLENDER_EEVEE_NEXT'):
            scene.render.engine = engine
        setup("a")
        """,
        [ENGINE],
    ),
    "a default with its type": (
        """
        def light(kind: str = 'POINTY'):
            bpy.ops.object.light_add(type=kind)
        light()
        """,
        ["bpy.ops.object.light_add(type):POINTY"],
    ),
    "a loop over a tuple": (
        "for engine in ('CYCLES', 'BLENDER_EEVEE_NEXT'):\n    scene.render.engine = engine",
        [ENGINE],
    ),
    "a loop over a list that a name holds": (
        "kinds = ['BEVEL', 'SUBSURFACE']\nfor kind in kinds:\n    ob.modifiers.new(kind, kind)",
        ["bpy.types.ObjectModifiers.new(type):SUBSURFACE"],
    ),
    "a loop over pairs": (
        'for name, value in (("Roughness", 0.2), ("Specular", 0.5)):\n'
        "    bsdf.inputs[name].default_value = value",
        [SPECULAR],
    ),
    "a loop over a dictionary": (
        'for name, value in {"IOR": 1.4, "Specular": 1.0}.items():\n'
        "    bsdf.inputs[name].default_value = value",
        [SPECULAR],
    ),
    "a loop that counts": (
        "for at, kind in enumerate(['ShaderNodeMix', 'ShaderNodeTexMusgrave']):\n    add(kind, x=at)",
        [MUSGRAVE],
    ),
    "a loop over what a call passes": (
        """
        def apply(node, settings):
            for name, value in settings.items():
                node.inputs[name].default_value = value
        apply(bsdf, {"Roughness": 0.5})
        apply(bsdf, {"Specular": 0.5, "Metallic": 1.0})
        """,
        [SPECULAR],
    ),
    "the first turn of a loop that is left": (
        """
        for engine in ('BLENDER_EEVEE_NEXT', 'CYCLES'):
            scene.render.engine = engine
            break
        """,
        [ENGINE],
    ),
    "an item, given to a call": (
        "chosen = {'kind': 'SUBSURFACE'}\nob.modifiers.new('a', chosen['kind'])",
        ["bpy.types.ObjectModifiers.new(type):SUBSURFACE"],
    ),
    "a loop over dictionaries": (
        """
        for row in [{'name': 'a', 'kind': 'BEVEL'}, {'name': 'b', 'kind': 'SUBSURFACE'}]:
            ob.modifiers.new(name=row['name'], type=row['kind'])
        """,
        ["bpy.types.ObjectModifiers.new(type):SUBSURFACE"],
    ),
    "a dictionary made by a call": (
        """
        for name, value in dict(IOR=1.4, Specular=1.0).items():
            bsdf.inputs[name].default_value = value
        """,
        [SPECULAR],
    ),
    "a class's own constant": (
        """
        class Config:
            ENGINE = 'BLENDER_EEVEE_NEXT'
        scene.render.engine = Config.ENGINE
        """,
        [ENGINE],
    ),
    "a constant of an object's class": (
        """
        class Maker:
            KIND = 'ShaderNodeTexMusgrave'
            def make(self):
                return tree.nodes.new(self.KIND)
        Maker().make()
        """,
        [MUSGRAVE],
    ),
    "a constant that a class inherits": (
        """
        class Base:
            ENGINE = 'BLENDER_EEVEE_NEXT'
        class Derived(Base):
            pass
        scene.render.engine = Derived.ENGINE
        """,
        [ENGINE],
    ),
    "what a field has by default": (
        """
        from dataclasses import dataclass
        @dataclass
        class Options:
            samples: int
            engine: str = 'BLENDER_EEVEE_NEXT'
        scene.render.engine = Options(8).engine
        """,
        [ENGINE],
    ),
    "what a call passes by names of its own": (
        """
        def apply(node, **settings):
            for name, value in settings.items():
                node.inputs[name].default_value = value
        apply(bsdf, Roughness=0.5)
        apply(bsdf, Specular=0.5, Metallic=1.0)
        """,
        [SPECULAR],
    ),
    "one setting by a name of its own": (
        """
        def add_math(**settings):
            node = tree.nodes.new('ShaderNodeMath')
            for name, value in settings.items():
                setattr(node, name, value)
        add_math(operation='TIMES')
        """,
        ["bpy.types.ShaderNodeMath.operation:TIMES"],
    ),
    "a branch of this Blender": (
        "engine = 'BLENDER_EEVEE_NEXT' if bpy.app.version >= (4, 2) else 'BLENDER_EEVEE'\nuse(engine)",
        [ENGINE],
    ),
    "what every call adds to the same list": (
        """
        class Keeper:
            def __init__(self):
                self.old = []
            def put(self, what, name, value):
                self.old.append([(what, name), getattr(what, name)])
                setattr(what, name, value)
        class Quick(Keeper):
            def __init__(self):
                Keeper.__init__(self)
                self.put(scene.render, "film_transparent", True)
                self.put(scene.eevee, "use_bloom", False)
                self.put(scene.render, "use_motion_blur", False)
        Quick()
        """,
        ["bpy.types.SceneEEVEE.use_bloom"] * 2,
    ),
}

TAKEN = {
    "a name that is asked for": """
        engine = 'BLENDER_EEVEE_NEXT'
        if engine in engines:
            scene.render.engine = engine
    """,
    "a name that is chosen": """
        engine = 'BLENDER_EEVEE_NEXT'
        if 'BLENDER_EEVEE_NEXT' not in engines:
            engine = 'BLENDER_EEVEE'
        scene.render.engine = engine
    """,
    "a name that is tried": """
        engine = 'BLENDER_EEVEE_NEXT'
        try:
            scene.render.engine = engine
        except TypeError:
            engine = 'BLENDER_EEVEE'
            scene.render.engine = engine
    """,
    "a name by the version": """
        if bpy.app.version < (5, 0, 0):
            engine = 'BLENDER_EEVEE_NEXT'
        else:
            engine = 'BLENDER_EEVEE'
        scene.render.engine = engine
    """,
    "a choice by the version": """
        engine = 'BLENDER_EEVEE_NEXT' if bpy.app.version < (5, 0, 0) else 'BLENDER_EEVEE'
        scene.render.engine = engine
    """,
    "a call that is tried": """
        try:
            use('BLENDER_EEVEE_NEXT')
        except TypeError:
            use('BLENDER_EEVEE')
    """,
    "a call for another version": """
        if bpy.app.version < (5, 0, 0):
            use('BLENDER_EEVEE_NEXT')
    """,
    "a call in a function for another version": """
        def before():
            use('BLENDER_EEVEE_NEXT')
        if bpy.app.version < (5, 0, 0):
            before()
    """,
    "a call behind a question": """
        if 'BLENDER_EEVEE_NEXT' in engines:
            use('BLENDER_EEVEE_NEXT')
    """,
    "a function that tries": """
        def careful(engine):
            try:
                scene.render.engine = engine
            except TypeError:
                scene.render.engine = 'CYCLES'
        careful('BLENDER_EEVEE_NEXT')
    """,
    "a function that asks": """
        def careful(kind):
            if not hasattr(bpy.types, kind):
                return None
            return tree.nodes.new(kind)
        careful('ShaderNodeTexMusgrave')
    """,
    "a function that compares": """
        def careful(kind):
            if kind == 'ShaderNodeTexMusgrave':
                kind = 'ShaderNodeTexNoise'
            return tree.nodes.new(kind)
        careful('ShaderNodeTexMusgrave')
    """,
    "a function that matches": """
        def careful(kind):
            match kind:
                case 'ShaderNodeTexMusgrave':
                    return None
                case _:
                    return tree.nodes.new(kind)
        careful('ShaderNodeTexMusgrave')
    """,
    "a function that looks a name up": """
        now = {'ShaderNodeTexMusgrave': 'ShaderNodeTexNoise'}
        def careful(kind):
            kind = now.get(kind, kind)
            return tree.nodes.new(kind)
        careful('ShaderNodeTexMusgrave')
    """,
    "a function with a switch": """
        def careful(kind, wanted=False):
            if wanted:
                tree.nodes.new(kind)
        careful('ShaderNodeTexMusgrave')
    """,
    "a loop that asks": """
        for name in ("Specular IOR Level", "Specular"):
            if name in bsdf.inputs:
                bsdf.inputs[name].default_value = 0.5
    """,
    "a loop that looks for one": """
        for name in ("Specular IOR Level", "Specular"):
            socket = bsdf.inputs.get(name)
            if socket:
                socket.default_value = 0.5
    """,
    "a loop that tries": """
        for engine in ('BLENDER_EEVEE_NEXT', 'BLENDER_EEVEE'):
            try:
                scene.render.engine = engine
                break
            except TypeError:
                continue
    """,
    "a loop that is left before": """
        for name in ("Specular IOR Level", "Specular"):
            bsdf.inputs[name].default_value = 0.5
            break
    """,
    "a loop with versions": """
        for kind, since in (('ShaderNodeTexNoise', (2, 80, 0)), ('ShaderNodeOfTomorrow', (9, 0, 0))):
            if bpy.app.version >= since:
                tree.nodes.new(kind)
    """,
    "a loop with switches": """
        for kind, is_old in (('ShaderNodeTexMusgrave', True), ('ShaderNodeTexNoise', False)):
            if is_old:
                continue
            tree.nodes.new(kind)
    """,
    "a loop that asks a function": """
        def exists(kind):
            return kind in dir(bpy.types)
        for kind in ('ShaderNodeTexMusgrave', 'ShaderNodeTexNoise'):
            is_there = exists(kind)
            if is_there:
                tree.nodes.new(kind)
    """,
    "a list that is filled elsewhere": """
        kinds = ['BEVEL', 'SUBSURFACE']
        kinds.pop()
        kinds.append('SUBSURF')
        for kind in kinds:
            ob.modifiers.new(kind, kind)
    """,
    "a list that is changed": """
        kinds = ['BEVEL', 'SUBSURFACE']
        kinds[1] = 'SUBSURF'
        for kind in kinds:
            ob.modifiers.new(kind, kind)
    """,
    "a constant that another class has otherwise": """
        class Base:
            ENGINE = 'BLENDER_EEVEE_NEXT'
            def set(self):
                scene.render.engine = self.ENGINE
        class Derived(Base):
            ENGINE = 'CYCLES'
        Derived().set()
    """,
    "a constant that is set from outside": """
        class Config:
            ENGINE = 'BLENDER_EEVEE_NEXT'
        Config.ENGINE = 'CYCLES'
        scene.render.engine = Config.ENGINE
    """,
    "a constant that an object has otherwise": """
        class Maker:
            KIND = 'ShaderNodeTexMusgrave'
            def __init__(self, kind):
                self.KIND = kind
        tree.nodes.new(Maker('ShaderNodeTexNoise').KIND)
    """,
    "a constant that is set by a name": """
        class Config:
            ENGINE = 'BLENDER_EEVEE_NEXT'
        for name, value in zip(["ENGINE"], ["CYCLES"]):
            setattr(Config, name, value)
        scene.render.engine = Config.ENGINE
    """,
    "a field with a value of its own": """
        from dataclasses import dataclass
        @dataclass
        class Options:
            engine: str = 'BLENDER_EEVEE_NEXT'
        scene.render.engine = Options(engine='CYCLES').engine
    """,
    "a field with a value by its place": """
        from dataclasses import dataclass
        @dataclass
        class Options:
            samples: int
            engine: str = 'BLENDER_EEVEE_NEXT'
        scene.render.engine = Options(8, 'CYCLES').engine
    """,
    "fields with what is not seen": """
        import dataclasses
        @dataclasses.dataclass
        class Options:
            engine: str = 'BLENDER_EEVEE_NEXT'
        scene.render.engine = Options(**{"engine": "CYCLES"}).engine
    """,
    "a field that is set later": """
        from dataclasses import dataclass
        @dataclass
        class Options:
            engine: str = 'BLENDER_EEVEE_NEXT'
        options = Options()
        options.engine = 'CYCLES'
        scene.render.engine = options.engine
    """,
    "a member of an enumeration": """
        from enum import StrEnum
        class Engine(StrEnum):
            NEXT = 'BLENDER_EEVEE_NEXT'
            BEST = 'CYCLES'
            @classmethod
            def _missing_(cls, value):
                return cls.BEST
        scene.render.engine = Engine.BEST
    """,
    "an item that is asked for": """
        chosen = {'engine': 'BLENDER_EEVEE_NEXT'}
        if chosen['engine'] in engines:
            use(chosen['engine'])
    """,
    "what is taken out of a dictionary": """
        settings = {"IOR": 1.4, "Specular": 0.5}
        settings.pop("Specular")
        for name, value in settings.items():
            bsdf.inputs[name].default_value = value
        settings = {"IOR": 1.4, "Specular": 0.5}
        del settings["Specular"]
        for name, value in settings.items():
            bsdf.inputs[name].default_value = value
        settings = {"Specular": 0.5}
        settings.clear()
        for name, value in settings.items():
            bsdf.inputs[name].default_value = value
    """,
    "what is taken out of a list": """
        names = ["IOR", "Specular"]
        names.remove("Specular")
        for name in names:
            bsdf.inputs[name].default_value = 1.4
        names = ["IOR", "Specular"]
        del names[1]
        for name in names:
            bsdf.inputs[name].default_value = 1.4
        names = ["Specular", "Specular"]
        names.clear()
        for name in names:
            bsdf.inputs[name].default_value = 1.4
    """,
    "what a function takes out": """
        def without(held, name):
            held.pop(name)
        settings = {"IOR": 1.4, "Specular": 0.5}
        without(settings, "Specular")
        for name, value in settings.items():
            bsdf.inputs[name].default_value = value
    """,
    "what is taken out of names of its own": """
        def apply(node, **settings):
            settings.pop("Specular", None)
            for name, value in settings.items():
                node.inputs[name].default_value = value
        apply(bsdf, Roughness=0.5, Specular=1.0)
    """,
    "a name that another function sets": """
        engine = 'BLENDER_EEVEE_NEXT'
        def choose():
            global engine
            engine = 'CYCLES'
        choose()
        def setup():
            scene.render.engine = engine
        setup()
    """,
}


@pytest.mark.parametrize(("lines", "symbols"), REFUSED.values(), ids=REFUSED)
def test_a_text_that_surely_comes_is_judged(rule_checker: Checker, lines: str, symbols: list[str]) -> None:
    findings = rule_checker.check(AROUND + dedent(lines))
    assert [finding.symbol for finding in findings if finding.severity == "error"] == symbols


@pytest.mark.parametrize("lines", TAKEN.values(), ids=TAKEN)
def test_a_text_that_may_not_come_is_not(rule_checker: Checker, lines: str) -> None:
    assert [finding.message for finding in rule_checker.check(AROUND + dedent(lines))] == []


def test_blender_refuses_the_same(tmp_path: Path) -> None:
    lines = [*(lines for lines, _ in REFUSED.values()), *TAKEN.values()]
    done = run_statements(tmp_path, [AROUND + dedent(each) for each in lines])
    failed = {name: bool(row[0]) for name, row in zip([*REFUSED, *TAKEN], done, strict=True)}
    assert failed == {name: name in REFUSED for name in failed}


def test_each_text_that_is_refused_is_told_where_it_is_used(rule_checker: Checker) -> None:
    lines = "\nuse('BLENDER_EEVEE_NEXT')\nuse('BLENDER_GAME')\nuse('CYCLES')\nuse('BLENDER_GAME')"
    findings = rule_checker.check(AROUND + lines, rules=["unknown-value"])
    place = next(at for at, line in enumerate(AROUND.splitlines(), 1) if "engine = engine" in line)
    assert [finding.span.line for finding in findings] == [place, place]
    assert ["BLENDER_GAME" in finding.message for finding in findings].count(True) == 1


def test_what_is_looked_up_is_not_edited(rule_checker: Checker) -> None:
    lines = "\nchosen = {'BLENDER_EEVEE_NEXT': 'BLENDER_EEVEE_NEXT'}\n"
    lines += "scene.render.engine = chosen['BLENDER_EEVEE_NEXT']"
    (finding,) = rule_checker.check(AROUND + lines, rules=["unknown-value"])
    assert finding.fix is None
