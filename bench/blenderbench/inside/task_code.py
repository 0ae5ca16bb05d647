# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the code of a task."""

import bpy


def execute(code, name):
    """Runs ``code`` in a namespace of its own. Returns None, or its exception: ``type``, ``message``, ``line``."""
    try:
        compiled = compile(code, name, "exec")
        exec(compiled, {"__name__": "__main__", "bpy": bpy})  # noqa: S102 - the process is confined
    except BaseException as error:
        return {"type": type(error).__name__, "message": _message(error), "line": _line(error, name)}
    return None


def _message(error):
    if isinstance(error, SystemExit):
        return f"the code called sys.exit({error.code!r})"
    try:
        return str(error)[:2000]
    except BaseException as fault:
        return f"(its message raises {type(fault).__name__})"


def _line(error, name):
    """The last line of the code that was reached; None if the exception has none."""
    if isinstance(error, SyntaxError):
        return error.lineno
    line, trace = None, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == name:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line
