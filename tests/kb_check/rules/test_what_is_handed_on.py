"""What decorators, context managers, iterators and calls by part hand on is what they were given, and nothing else."""

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
import contextlib
import functools
import itertools
cam = bpy.data.cameras.new("c")
def new(name):
    return bpy.data.objects.new(name, None)
made = [new("a"), new("b"), new("c")]
"""
LACKING = {
    "what a function yields that with enters": """
        @contextlib.contextmanager
        def kept(one):
            yield one
        with kept(made[0]) as one:
            one.draw_type = 'WIRE'
    """,
    "what a stack enters": """
        @contextlib.contextmanager
        def kept(one):
            yield one
        with contextlib.ExitStack() as stack:
            stack.enter_context(kept(made[0])).draw_type = 'WIRE'
    """,
    "what a function returns that is timed": """
        def timed(function):
            @functools.wraps(function)
            def wrapper(*args, **kwargs):
                try:
                    return function(*args, **kwargs)
                finally:
                    print("done")
            return wrapper
        @timed
        def make(name):
            return new(name)
        make("a").draw_type = 'WIRE'
    """,
    "what a function returns that keeps the result": """
        def told(function):
            def wrapper(*args, **kwargs):
                result = function(*args, **kwargs)
                print(result)
                return result
            return wrapper
        @told
        def make(name):
            return new(name)
        make("a").draw_type = 'WIRE'
    """,
    "what a function returns that is registered": """
        makers = {}
        def maker(kind):
            def register(function):
                makers[kind] = function
                return function
            return register
        @maker("empty")
        def make(name):
            return new(name)
        make("a").draw_type = 'WIRE'
    """,
    "pairs that follow each other": """
        for one, other in itertools.pairwise(made):
            other.draw_type = 'WIRE'
    """,
    "an iterator twice": """
        first, second = itertools.tee(made)
        next(second)
        for one, other in zip(first, second):
            other.draw_type = 'WIRE'
    """,
    "groups": """
        for key, group in itertools.groupby(made, key=lambda one: one.type):
            for one in group:
                one.draw_type = 'WIRE'
    """,
    "what groups are made by": """
        list(itertools.groupby(made, lambda one: one.draw_type))
    """,
    "what a list is sorted by": """
        sorted(made, key=lambda one: one.draw_type)
    """,
    "the first of a list": """
        for one in itertools.takewhile(lambda one: one.type == 'EMPTY', made):
            one.draw_type = 'WIRE'
    """,
    "a list in parts": """
        for part in itertools.batched(made, 2):
            part[0].draw_type = 'WIRE'
    """,
    "what a class makes that has some names": """
        class Part:
            def __init__(self, name, size=1.0):
                self.obj = new(name)
                self.size = size
        half = functools.partial(Part, size=0.5)
        half("a").obj.draw_type = 'WIRE'
    """,
    "one list or none": """
        for one in bpy.context.scene.collection.objects if cam else []:
            one.location.x += 1
        bpy.context.scene.collection.objects.link(made[0])
        for one in bpy.context.scene.collection.objects if cam else []:
            one.draw_type = 'WIRE'
    """,
}
RIGHT = {
    "what a decorator puts in the place of a result": """
        def as_camera(function):
            @functools.wraps(function)
            def wrapper(*args, **kwargs):
                function(*args, **kwargs)
                return cam
            return wrapper
        @as_camera
        def make(name):
            return new(name)
        make("a").lens = 35
    """,
    "what a decorator passes besides": """
        def with_camera(function):
            @functools.wraps(function)
            def wrapper(*args, **kwargs):
                return function(cam, *args, **kwargs)
            return wrapper
        @with_camera
        def use(one, other):
            one.lens = 35
        use(made[0])
    """,
    "what a decorator returns after an error": """
        def safe(function):
            def wrapper(*args, **kwargs):
                try:
                    return function(*args, **kwargs)
                except RuntimeError:
                    return None
            return wrapper
        @safe
        def make(name):
            raise RuntimeError(name)
        if make("a") is None:
            cam.lens = 35
    """,
    "what a decorator makes of a function": """
        def called(function):
            return function("a")
        @called
        def make(name):
            return cam
        make.lens = 35
    """,
    "what a maker of decorators counts": """
        def twice(times):
            def wrap(function):
                def wrapper(*args, **kwargs):
                    return [function(*args, **kwargs) for _ in range(times)]
                return wrapper
            return wrap
        @twice(2)
        def make(name):
            return cam
        make("a")[0].lens = 35
    """,
    "another name of a partial call": """
        class Part:
            def __init__(self, held=None):
                self.held = held
        lens = functools.partial(Part, held=cam)
        lens().held.lens = 35
    """,
}


@pytest.mark.parametrize("lines", LACKING.values(), ids=LACKING)
def test_what_is_handed_on_is_known(rule_checker: Checker, lines: str) -> None:
    findings = rule_checker.check(AROUND + dedent(lines), rules=["unknown-attribute"])
    assert [finding.symbol for finding in findings] == ["bpy.types.Object.draw_type"]


@pytest.mark.parametrize("lines", RIGHT.values(), ids=RIGHT)
def test_what_becomes_something_else_is_no_finding(rule_checker: Checker, lines: str) -> None:
    assert [finding.message for finding in rule_checker.check(AROUND + dedent(lines))] == []


@pytest.mark.blender
def test_blender_says_the_same(tmp_path: Path) -> None:
    done = run_statements(
        tmp_path, [AROUND + dedent(lines) for lines in (*LACKING.values(), *RIGHT.values())]
    )
    failed = {name: bool(row[0]) for name, row in zip([*LACKING, *RIGHT], done, strict=True)}
    assert failed == {name: name in LACKING for name in failed}
