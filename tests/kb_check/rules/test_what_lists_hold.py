"""Lists and dictionaries that begin empty: what is taken from them is what was put there, and nothing else."""

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
cam = bpy.data.cameras.new("c")
def new(name):
    return bpy.data.objects.new(name, None)
"""
LACKING = {
    "a list filled in a loop": """
        made = []
        for at in range(3):
            made.append(new(str(at)))
        for one in made:
            one.draw_type = 'WIRE'
    """,
    "a list filled on one way": """
        made = []
        if cam.users == 0:
            made.append(new("a"))
        made[0].draw_type = 'WIRE'
    """,
    "a list that a function returns": """
        def make():
            made = list()
            for at in range(3):
                made += [new(str(at))]
            return made
        make()[1].draw_type = 'WIRE'
    """,
    "a dictionary filled in a loop": """
        made = {}
        for name in "abc":
            made[name] = new(name)
        for name, one in made.items():
            one.draw_type = 'WIRE'
    """,
    "a dictionary made by a call": """
        made = dict(a=new("a"))
        made["a"].draw_type = 'WIRE'
    """,
    "a dictionary made of pairs": """
        made = dict(zip("ab", bpy.data.objects))
        made["a"].draw_type = 'WIRE'
    """,
    "a list by its key": """
        from collections import defaultdict
        made = defaultdict(list)
        made["a"].append(new("a"))
        made["a"][0].draw_type = 'WIRE'
    """,
    "a list by its key, made where it is missing": """
        made = {}
        for at in range(3):
            made.setdefault(at % 2, []).append(new(str(at)))
        for group in made.values():
            for one in group:
                one.draw_type = 'WIRE'
    """,
    "a queue": """
        from collections import deque
        waiting = deque()
        waiting.append(new("a"))
        waiting.popleft().draw_type = 'WIRE'
    """,
    "one of a list by chance": """
        import random
        random.choice([new("a"), new("b")]).draw_type = 'WIRE'
    """,
    "some of a list by chance": """
        from random import sample
        for one in sample([new("a"), new("b")], 1):
            one.draw_type = 'WIRE'
    """,
    "pairs of a list": """
        import itertools
        for first, second in itertools.combinations([new("a"), new("b")], 2):
            second.draw_type = 'WIRE'
    """,
    "each by a function": """
        for one in map(new, "ab"):
            one.draw_type = 'WIRE'
    """,
    "a list of an object's": """
        class Builder:
            def __init__(self):
                self.made = []
            def add(self):
                self.made.append(new("a"))
            def hide(self):
                for one in self.made:
                    one.draw_type = 'WIRE'
        builder = Builder()
        builder.add()
        builder.hide()
    """,
    "a dictionary of an object's": """
        class Builder:
            def __init__(self):
                self.made = {}
            def add(self, name):
                self.made[name] = new(name)
            def hide(self, name):
                self.made[name].draw_type = 'WIRE'
        builder = Builder()
        builder.add("a")
        builder.hide("a")
    """,
}
RIGHT = {
    "a list that a function fills with other things": """
        def fill(held):
            held.append(cam)
        held = []
        fill(held)
        if bpy.data.objects:
            held.append(new("a"))
        held[0].lens = 35
    """,
    "a list that holds several kinds": """
        held = []
        for at in range(3):
            held.append(new("a") if at else cam)
        held[0].lens = 35
    """,
    "a list added to another one": """
        def cameras():
            return [cam]
        held = []
        held += cameras()
        for at in range(2):
            held.append(new("a"))
        held[0].lens = 35
    """,
    "lists of a dictionary": """
        held = {"objects": [new("a")], "cameras": []}
        held["cameras"].append(cam)
        for name in ("cameras",):
            for one in held[name]:
                one.lens = 35
    """,
    "lists by their keys": """
        from collections import defaultdict
        held = defaultdict(list)
        held["cameras"].append(cam)
        held["objects"].append(new("a"))
        held["cameras"][0].lens = 35
    """,
    "a list by its key, that a function fills": """
        def fill(held):
            held["a"].append(cam)
        held = {"a": []}
        fill(held)
        held["a"].append(new("a"))
        held["a"][0].lens = 35
    """,
    "one of several kinds by chance": """
        import random
        held = random.choice([cam, new("a")])
        if held is cam:
            held.lens = 35
    """,
    "a function called like one of Python's": """
        def choice(held):
            return cam
        choice([new("a")]).lens = 35
    """,
    "a list that is one by default": """
        def first(held=[]):
            held.append(new("a"))
            held[0].lens = 35
        first(getattr(bpy, "held", [cam]))
    """,
    "a list that was filled by an earlier call": """
        def first(is_camera, held=[]):
            if is_camera:
                held.append(cam)
            else:
                held.append(new("a"))
            return held[0]
        first(True)
        first(False).lens = 35
    """,
    "some of what passes by": """
        from itertools import islice
        for instance in islice(bpy.context.evaluated_depsgraph_get().object_instances, 3):
            instance.matrix_world
    """,
    "a list that two names hold": """
        first = second = []
        second.append(cam)
        first.append(new("a"))
        first[0].lens = 35
    """,
    "a list that an object holds, too": """
        class Builder:
            def __init__(self):
                held = []
                self.held = held
                held.append(cam)
            def add(self):
                self.held.append(new("a"))
        builder = Builder()
        builder.add()
        builder.held[0].lens = 35
    """,
    "a list of an object's that a function fills": """
        def fill(held):
            held.append(cam)
        class Builder:
            def __init__(self):
                self.held = []
                fill(self.held)
                self.held.append(new("a"))
        Builder().held[0].lens = 35
    """,
    "a list that holds another one": """
        groups = []
        for at in range(2):
            groups.append([cam] if at == 0 else [new("a")])
        groups[0][0].lens = 35
    """,
}


@pytest.mark.parametrize("lines", LACKING.values(), ids=LACKING)
def test_what_was_put_into_a_list_is_known_where_it_is_taken_out(rule_checker: Checker, lines: str) -> None:
    findings = rule_checker.check(AROUND + dedent(lines), rules=["unknown-attribute"])
    assert [finding.symbol for finding in findings] == ["bpy.types.Object.draw_type"]


@pytest.mark.parametrize("lines", RIGHT.values(), ids=RIGHT)
def test_what_else_may_be_in_it_is_no_finding(rule_checker: Checker, lines: str) -> None:
    assert [finding.message for finding in rule_checker.check(AROUND + dedent(lines))] == []


def test_blender_says_the_same(tmp_path: Path) -> None:
    done = run_statements(
        tmp_path, [AROUND + dedent(lines) for lines in (*LACKING.values(), *RIGHT.values())]
    )
    failed = {name: bool(row[0]) for name, row in zip([*LACKING, *RIGHT], done, strict=True)}
    assert failed == {name: name in LACKING for name in failed}
