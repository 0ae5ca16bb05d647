# SPDX-License-Identifier: GPL-3.0-or-later
"""Does the steps of topics in this environment's Blender, each topic in a copy of it: ``python run_steps.py TOPICS``.

TOPICS is a JSON file: name → steps, a list of lines. Prints a JSON line for each topic: ``{"topic": …, "done": number,
"left": number, "failed": [[step, error], …]}``. What makes or fills something is run; what is set is set to what it
has; what is called is looked up. From an operator on that makes something, and cannot run on a mesh object, steps are
left: they would fail whatever they say.
"""

from __future__ import annotations

import ast
import builtins
import json
import os
import re
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

Names = dict[str, Any]

_CODE = re.compile(r"`([^`]*)`")
_NUMBER = re.compile(r"^\d+\. ")
_SET = re.compile(r"set on `([^`]*)`(?: \(`[^`]*`\))?: (.*)")
_SETTING = re.compile(r"`(\w+)`(?! \(after )")
_HELD = re.compile(r"in `([^`]*)`: (.*)")
_COLLECTION = re.compile(r"`\.(\w+)`")
_MAKES = re.compile(r"(.*) makes `([^`]*)`$")
_TOLD = re.compile(r" — | → |; also|`\)? \((?=`)")
# What a reader puts in the place of an argument's name.
_GIVEN = {
    "width": 64, "height": 64, "channel": 1, "frame_start": 1, "length": 25, "start": 1, "frame": 1, "frame_number": 1,
    "data_path": "location",
}  # fmt: skip


class _UnjudgedError(Exception):
    """What comes now cannot be judged."""


def _names() -> Names:
    """A scene with an active mesh object, ``obj``, and another."""
    bpy: Any = import_module("bpy")
    other = bpy.data.objects.new("other", bpy.data.meshes.new("other"))
    bpy.context.collection.objects.link(other)
    obj = bpy.context.object
    held = {"bpy": bpy, "obj": obj, "other": other, "scene": bpy.context.scene, "target_id": obj}
    return {**_GIVEN, **held, "view_layer": bpy.context.view_layer, "bmesh": import_module("bmesh")}


def _is_known(node: ast.AST, names: Names) -> bool:
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and part.id not in names and not hasattr(builtins, part.id):
            return False
        if isinstance(part, ast.Constant) and part.value is ...:
            return False
    return True


def _run(code: str, names: Names) -> None:
    for statement in ast.parse(code).body:
        call = statement.value if isinstance(statement, (ast.Assign, ast.Expr)) else None
        while isinstance(call, ast.Attribute):
            call = call.value
        given = [*call.args, *(word.value for word in call.keywords)] if isinstance(call, ast.Call) else []
        if isinstance(call, ast.Call) and not all(_is_known(argument, names) for argument in given):
            if not callable(eval(ast.unparse(call.func), names)):  # noqa: S307 - our own answers
                raise TypeError(f"{ast.unparse(call.func)} cannot be called")
            if isinstance(statement, ast.Assign):
                raise _UnjudgedError
            return
        if code.startswith("tree.links.new("):
            if not eval(code, names).is_valid:  # noqa: S307 - our own answers
                raise ValueError("the link joins sockets of different kinds")
            return
        exec(compile(ast.Module([statement], []), "step", "exec"), names)  # noqa: S102 - likewise
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if isinstance(target, ast.Name) and names[target.id] is None:
            raise ValueError(f"{target.id} is None")


def _check_set(expression: str, settings: str, names: Names) -> None:
    value = eval(expression, names)  # noqa: S307 - our own answers
    for name in _SETTING.findall(settings):
        had = getattr(value, name)
        with suppress(TypeError):  # a value that only a new one has, as an empty name
            setattr(value, name, had)


def _check_held(expression: str, collections: str, names: Names) -> None:
    value = eval(expression, names)  # noqa: S307 - our own answers
    for name in _COLLECTION.findall(collections):
        getattr(value, name)


def _fill(calls: str, pointer: str, names: Names) -> None:
    for code in _CODE.findall(calls):
        _run(code, names)
    if eval(pointer, names) is None:  # noqa: S307 - our own answers
        raise ValueError(f"{pointer} is still None")


def _operate(step: str, names: Names) -> None:
    """An operator that makes a thing is called, if what it says to need is there, and so is one of which nothing is
    said, as that which changes the mode; of others ``poll`` is asked.
    """
    codes = _CODE.findall(step)
    if step == "; ".join(f"`{code}`" for code in codes):
        for code in codes:
            _run(code, names)
        return
    code = codes[0]
    runs = eval(code.partition("(")[0], names).poll()  # noqa: S307 - our own answers
    is_told = " (takes " in step or " (not seen " in step
    if " → " in step:
        if is_told and not runs:
            raise _UnjudgedError
        _run(code, names)
    elif not (runs or is_told):
        raise RuntimeError("poll() failed")


def _do(step: str, names: Names) -> None:
    """Does one step. Raises what Blender raises."""
    step = _NUMBER.sub("", step)
    if step.startswith("set, once"):
        return
    for pattern, act in ((_SET, _check_set), (_HELD, _check_held), (_MAKES, _fill)):
        if found := pattern.match(step):
            act(found[1], found[2], names)
            return
    if step.startswith("call "):
        for call in _CODE.findall(step):
            eval(call.partition("(")[0], names)  # noqa: S307 - our own answers
    elif step.startswith("`bpy.ops."):
        _operate(step, names)
    else:
        for code in _CODE.findall(step if step.startswith("on another") else _TOLD.split(step)[0] + "`"):
            _run(code, names)


def _done(topic: str, steps: list[str]) -> dict[str, Any]:
    names, failed = _names(), list[tuple[str, str]]()
    for number, step in enumerate(steps):
        try:
            _do(step, names)
        except _UnjudgedError:
            return {"topic": topic, "done": number, "left": len(steps) - number, "failed": failed}
        except Exception as error:
            failed.append((step, f"{type(error).__name__}: {error}"))
    return {"topic": topic, "done": len(steps), "left": 0, "failed": failed}


def main(path: str) -> None:
    """Does all topics of a file."""
    output = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Blender prints as it likes
    import_module("bpy")  # once, for all the copies
    for topic, steps in json.loads(Path(path).read_text(encoding="utf-8")).items():
        if process := os.fork():
            if os.waitpid(process, 0)[1]:
                row = {"topic": topic, "done": 0, "left": 0, "failed": [("", "Blender ended")]}
                os.write(output, f"{json.dumps(row)}\n".encode())
            continue
        os.write(output, f"{json.dumps(_done(topic, steps))}\n".encode())
        os._exit(0)
    os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1])
