"""What the run puts in the place of a value makes it no sure one: each of these scripts runs."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

# ``foo`` is what Blender's object lacks, and the other one has.
AROUND = """
import bpy
class Other:
    foo = 1
other = Other()
cube = bpy.data.objects.new("a", None)
"""
CHANGED = {
    "global": """
        ob = cube
        def f():
            global ob
            ob = other
        f()
        ob.foo
    """,
    "global in function": """
        ob = cube
        def f():
            global ob
            ob = other
        def main():
            f()
            ob.foo
        main()
    """,
    "global in another function's inner one": """
        ob = cube
        def f():
            ob = 1
            def g():
                global ob
                ob = other
            g()
        def main():
            f()
            ob.foo
        main()
    """,
    "nonlocal two functions further in": """
        def main():
            x = cube
            def g():
                def h():
                    nonlocal x
                    x = other
                h()
            g()
            return x.foo
        main()
    """,
    "globals": """
        ob = cube
        def f():
            globals()["ob"] = other
        f()
        ob.foo
    """,
    "globals by computed names": """
        ob = cube
        def f(**values):
            globals().update(values)
        f(ob=other)
        ob.foo
    """,
    "nonlocal": """
        def main():
            x = cube
            def g():
                nonlocal x
                x = other
            g()
            return x.foo
        main()
    """,
    "update": """
        d = {"a": cube}
        d.update(a=other)
        d["a"].foo
    """,
    "dict store": """
        d = {"a": cube}
        d["a"] = other
        d["a"].foo
    """,
    "list store": """
        l = [cube]
        l[0] = other
        l[0].foo
    """,
    "list insert": """
        l = [cube]
        l.insert(0, other)
        l[0].foo
    """,
    "setattr": """
        class C:
            ob = cube
        c = C()
        setattr(c, "ob", other)
        c.ob.foo
    """,
    "__dict__": """
        class C:
            ob = cube
        c = C()
        c.__dict__["ob"] = other
        c.ob.foo
    """,
    "__dict__ update": """
        class C:
            def __init__(self): self.ob = cube
        c = C()
        c.__dict__.update(ob=other)
        c.ob.foo
    """,
    "vars": """
        class C:
            def __init__(self): self.ob = cube
        c = C()
        vars(c)["ob"] = other
        c.ob.foo
    """,
    "default": """
        def f(o=cube):
            return o.foo
        f(other)
    """,
    "override": """
        class B:
            def o(self): return cube
            def go(self): return self.o().foo
        class D(B):
            def o(self): return other
        D().go()
    """,
    "override attr": """
        class B:
            ob = cube
            def go(self): return self.ob.foo
        class D(B):
            ob = other
        D().go()
    """,
    "filled": """
        state = {"ob": cube}
        def fill():
            state["ob"] = other
        fill()
        state["ob"].foo
    """,
    "filled list": """
        items = [cube]
        def fill():
            items[0] = other
        fill()
        items[0].foo
    """,
    "append fn": """
        items = []
        items.append(cube)
        def fill():
            items.append(other)
        fill()
        items[-1].foo
    """,
    "attr through param": """
        class C: pass
        def fill(c): c.ob = other
        c = C()
        c.ob = cube
        fill(c)
        c.ob.foo
    """,
    "in attr": """
        class C:
            def __init__(self):
                self.d = {"a": cube}
            def fill(self):
                self.d["a"] = other
            def go(self):
                self.fill()
                return self.d["a"].foo
        C().go()
    """,
    "clear": """
        l = [cube]
        l[:] = [other]
        l[0].foo
    """,
    "star default": """
        def f(*, o=cube):
            return o.foo
        f(o=other)
    """,
    "lambda default": """
        f = lambda o=cube: o.foo
        f(other)
    """,
    "handed on": """
        def f(o=cube):
            return o.foo
        list(map(f, [other]))
    """,
}
KEPT = {
    "itself": """
        cube.foo
    """,
    "an item of a list": """
        l = [cube]
        l[0].foo
    """,
    "an item of a dictionary": """
        d = {"a": cube}
        d["a"].foo
    """,
    "a default": """
        def f(o=cube):
            return o.foo
        f()
    """,
    "an attribute": """
        class C:
            ob = cube
            def go(self):
                return self.ob.foo
        C().go()
    """,
    "a name beside a call": """
        ob = cube
        def f():
            print(1)
        f()
        ob.foo
    """,
    "what another global is": """
        x = 1
        def f():
            global x
            x = 2
        f()
        cube.foo
    """,
    "a name that another function takes from the module": """
        def f():
            global ob
            ob = other
        def g():
            ob = cube
            ob.foo
        f()
        g()
    """,
    "a name beside one of globals": """
        x = other
        def f():
            globals()["x"] = 1
        f()
        cube.foo
    """,
    "a name that another function fills": """
        held = []
        def f():
            held.append(other)
        def g():
            held = cube
            held.foo
        f()
        g()
    """,
    "what a function around names": """
        def f():
            x = other
            def g():
                x = cube
                def h():
                    x.foo
                h()
            def k():
                nonlocal x
                x = None
            k()
            g()
        f()
    """,
    "what was appended": """
        l = []
        l.append(cube)
        l[0].foo
    """,
}


def _errors(checker: Checker, lines: str) -> list[str]:
    findings = checker.check(AROUND + dedent(lines))
    return [finding.symbol for finding in findings if finding.severity == "error"]


@pytest.mark.parametrize("lines", CHANGED.values(), ids=CHANGED)
def test_a_value_that_the_run_changes_is_not_sure(rule_checker: Checker, lines: str) -> None:
    assert _errors(rule_checker, lines) == []


@pytest.mark.parametrize("lines", KEPT.values(), ids=KEPT)
def test_a_value_that_stays_is_sure(rule_checker: Checker, lines: str) -> None:
    assert _errors(rule_checker, lines) == ["bpy.types.Object.foo"]


def test_what_is_changed_runs(tmp_path: Path) -> None:
    done = run_statements(tmp_path, [AROUND + dedent(lines) for lines in CHANGED.values()])
    assert {name: row[0] for name, row in zip(CHANGED, done, strict=True) if row[0]} == {}


def test_values_that_are_called_as_something_in_the_file_are_taken(
    rule_checker: Checker, tmp_path: Path
) -> None:
    code = """
import bpy
layer = bpy.context.view_layer
layer.name = "Main"
layer.use_pass_cryptomatte_material = True
node = bpy.data.node_groups.new("t", "CompositorNodeTree").nodes.new("CompositorNodeCryptomatteV2")
node.scene = bpy.context.scene
node.layer_name = "Main.CryptoMaterial"
layer.aovs.add().name = "own"
screen = bpy.data.screens["Layout"]
space = next(area.spaces.active for area in screen.areas if area.type == "VIEW_3D")
space.shading.render_pass = "own"
"""
    assert [error for error, *_ in run_statements(tmp_path, [code])] == [""]
    assert [one.message for one in rule_checker.check(code) if one.severity == "error"] == []
