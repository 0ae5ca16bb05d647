# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one script in this environment's Blender and writes down every error: ``python run_one.py SCRIPT``.

A statement that fails is left out and the next one runs, so one script tells several errors. Prints JSON lines:
``{"ran": line}`` for a statement that ended well at least once, ``{"line": …, "type": …, "message": …}`` for an error,
by the first line of the statement, and ``{"ended": true}``. What takes long or ends Blender is not run.
"""

from __future__ import annotations

import ast
import json
import sys
import traceback
from pathlib import Path
from typing import Any

# Renders and bakes take minutes, and say nothing of the code; Blender is not to be ended.
_LONG = ("render.render", "render.opengl", "bake", "bake_all", "bake_data", "quit_blender", "simulation_nodes_cache_bake")
_COMPOUND = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


class _Wrapped(ast.NodeTransformer):
    """Puts every statement into a ``try`` of its own."""

    def body(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        return [wrapped for statement in statements for wrapped in self._wrap(statement)]

    def _wrap(self, node: ast.stmt) -> list[ast.stmt]:
        if isinstance(node, (ast.Global, ast.Nonlocal, ast.Pass, ast.Break, ast.Continue)):
            return [node]
        if isinstance(node, ast.ImportFrom) and node.module == "__future__":
            return [node]
        if _takes_long(node):
            return [ast.copy_location(ast.Pass(), node)]
        if not isinstance(node, (ast.Try, ast.TryStar)):  # what the script catches is its own matter
            for field in ("body", "orelse"):
                if (inner := getattr(node, field, None)) and not isinstance(node, ast.ClassDef):
                    setattr(node, field, self.body(inner))
            if isinstance(node, ast.ClassDef):
                node.body = [
                    self._method(each) if isinstance(each, ast.FunctionDef) else each for each in node.body
                ]
        line = ast.Constant(node.lineno)
        handler = ast.ExceptHandler(
            ast.Name("BaseException", ast.Load()),
            "__error__",
            [_call("__failed__", line, ast.Name("__error__", ast.Load()))],
        )
        ending = isinstance(node, (ast.Return, ast.Raise))
        before = [_call("__ran__", line)] if isinstance(node, ast.Return) else []
        after = [] if ending else [_call("__ran__", line)]
        if isinstance(node, ast.Raise):
            return [node]
        if isinstance(node, ast.Return) and node.value is not None:
            # The value is found before it is said to have been.
            value = ast.Assign([ast.Name("__value__", ast.Store())], node.value)
            node = ast.Return(ast.Name("__value__", ast.Load()))
            inner = [ast.copy_location(value, handler), *before, node]
        else:
            inner = [*before, node, *after]
        return [ast.Try(inner, [handler], [], [])]

    def _method(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.body = self.body(node.body)
        return node


def _takes_long(node: ast.stmt) -> bool:
    if hasattr(node, "body"):
        return False
    calls = (ast.unparse(each.func) for each in ast.walk(node) if isinstance(each, ast.Call))
    return any(call.startswith("bpy.ops.") and call.endswith(_LONG) for call in calls)


def _call(name: str, *arguments: ast.expr) -> ast.stmt:
    return ast.Expr(ast.Call(ast.Name(name, ast.Load()), list(arguments), []))


def main(path: str) -> None:
    """Runs the script as ``__main__``."""
    code = Path(path).read_text(encoding="utf-8")
    tree = ast.parse(code)
    statements = {node.lineno: node for node in ast.walk(tree) if isinstance(node, ast.stmt)}
    seen: set[tuple[Any, ...]] = set()

    def say(row: dict[str, Any]) -> None:
        key = tuple(row.items())
        if key not in seen:
            seen.add(key)
            print("\x1e" + json.dumps(row), flush=True)

    def failed(line: int, error: BaseException) -> None:
        if isinstance(error, (SystemExit, KeyboardInterrupt)):
            say({"stopped": line})
            return
        frames = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == path]
        inner = frames[-1] if frames else line
        # An error in a function that was not wrapped (a lambda) belongs to the line where it happens.
        where = line if inner not in statements or line <= inner <= (statements[line].end_lineno or line) else inner
        say({"line": where, "type": type(error).__name__, "message": str(error)[:600]})

    tree.body = _Wrapped().body(tree.body)
    ast.fix_missing_locations(tree)
    names = {
        "__name__": "__main__",
        "__file__": path,
        "__failed__": failed,
        "__ran__": lambda line: say({"ran": line}),
    }
    exec(compile(tree, path, "exec"), names)  # noqa: S102 - scripts of this project's own
    say({"ended": True})


if __name__ == "__main__":
    import bpy

    bpy.ops.wm.read_factory_settings()
    main(sys.argv[1])
