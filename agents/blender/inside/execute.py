# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs code in a fresh namespace and returns its value, its changes to the file, and its error."""

import ast
import contextlib
import linecache
import sys
import traceback

import bpy

from .api_suspects import documentation_query, existing_names
from .changes import MOST_BLOCKS, ChangeWatch, counts, in_brief

FILE = "<blender_execute>"
_LONGEST_VALUE = 4000
_LONGEST_TRACEBACK = 6000
_LINES_AROUND = 3  # lines shown before and after the one that failed


def execute(arguments, report):
    """Runs ``code``. Returns ``value`` (of a final expression), ``error`` if it failed, what has ``changed`` in brief,
    the ``counts`` of that, and the ``mode`` that Blender is in; ``unwatched`` says why changes are unknown."""
    del report
    from . import interpreter_state  # the user's own Blender, where code runs too, keeps another

    def restore(loaded):
        interpreter_state.current.stop_alarms_and_tracers()  # pyright: ignore[reportAttributeAccessIssue]
        interpreter_state.current.names.forget_modules(loaded)  # pyright: ignore[reportAttributeAccessIssue]
        interpreter_state.current.restore_names()  # pyright: ignore[reportAttributeAccessIssue]

    return run_watched(arguments["code"], restore, follows=True)


def run_watched(code, restore=None, around=contextlib.nullcontext, most=MOST_BLOCKS, *, follows=False):
    """Runs code within ``around()``, as ``execute``; changes are told by ``ChangeWatch(most, follows=follows)``.

    ``restore`` mends the interpreter afterwards; it gets the modules that were loaded before.
    """
    linecache.cache[FILE] = (len(code), None, code.splitlines(keepends=True), FILE)
    result = {"value": None, "error": None}
    watch = ChangeWatch(most, follows=follows)
    loaded = {*sys.modules}
    failure = None
    try:
        with around():
            result["value"] = _run(code)
    except BaseException as error:
        failure = error
    # The code may have patched what is used below, or left a tracer or an alarm that raises here once.
    for _ in range(3):
        try:
            if restore is not None:
                restore(loaded)
            break
        except Exception:
            continue
    if failure is not None:
        result["error"] = _describe_error(failure, code)
        failure = None  # frees the code's names
    try:
        differences = watch.differences()
        result["changed"], result["counts"] = in_brief(differences), counts(differences)
    except Exception as error:
        result["changed"], result["counts"] = {}, {}
        result["unwatched"] = f"{type(error).__name__}: {error}"
    result["mode"] = bpy.context.mode
    return result


def _run(code):
    tree = ast.parse(code, FILE)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    namespace = {"__name__": "__main__", "__builtins__": __builtins__, "bpy": bpy}
    exec(compile(tree, FILE, "exec"), namespace)  # noqa: S102 - what the tool is for; the process is confined
    if last is None:
        return None
    value = eval(compile(ast.Expression(last.value), FILE, "eval"), namespace)  # noqa: S307 - as above
    return None if value is None else _describe_value(value)


def _describe_value(value):
    try:
        text = repr(value)
    except Exception as error:
        text = f"<{type(value).__name__}, repr() failed: {type(error).__name__}: {error}>"
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}… ({len(text)} characters)"


def _describe_error(error, code):
    """An exception as data: ``type``, ``message``, ``line`` (1-based), ``source`` around it, ``traceback``, ``ask``
    (query for the documentation), ``there`` (names that exist instead of a missing one)."""
    if isinstance(error, SyntaxError):
        line, frame, span = error.lineno, None, None
        formatted = traceback.format_exception_only(error)
    else:
        outer, inner = _executed_frames(error.__traceback__)
        line = inner.tb_lineno if inner else None
        frame = inner.tb_frame if inner else None
        span = _failed_span(inner) if inner else None
        formatted = traceback.format_exception(type(error), error, outer)
    lines = code.splitlines()
    ask, there = "", []
    if frame is not None and line:
        try:
            failed = lines[line - 1] if line <= len(lines) else ""
            ask = documentation_query(error, frame, failed, span)
            there = existing_names(error, frame, failed, span)
        except Exception as fault:
            sys.stderr.write(f"(could not tell what the error is about: {fault!r})\n")
    try:
        message = str(error)
    except BaseException as fault:
        message = f"<no message: str() failed with {type(fault).__name__}>"
    if isinstance(error, SystemExit):
        message = f"the code called sys.exit({error.code!r}), which does not end Blender here"
    return {
        "type": type(error).__name__,
        "message": message[:2000],
        "line": line,
        "source": _lines_around(lines, line),
        "traceback": "".join(formatted)[-_LONGEST_TRACEBACK:],
        "ask": ask,
        "there": there,
    }


def _executed_frames(trace):
    """(outermost, innermost) frame of a traceback that is in the executed code; (None, None) if there is none."""
    outer = inner = None
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == FILE:
            outer, inner = outer or trace, trace
        trace = trace.tb_next
    return outer, inner


def _failed_span(trace):
    """(first, last) column in bytes of what failed on the line, if Python knows."""
    positions = getattr(trace.tb_frame.f_code, "co_positions", None)
    if positions is None:
        return None
    for number, place in enumerate(positions()):
        if number == trace.tb_lasti // 2:
            first, last = place[2], place[3]
            return (first, last) if first is not None and place[0] == place[1] else None
    return None


def _lines_around(lines, line):
    if not line:
        return ""
    first, last = max(1, line - _LINES_AROUND), min(len(lines), line + _LINES_AROUND)
    return "\n".join(
        f"{'>' if number == line else ' '} {number:4d}  {lines[number - 1][:200]}"
        for number in range(first, last + 1)
    )
