# SPDX-License-Identifier: GPL-3.0-or-later
"""Which piece of Blender's API an error is about: what to ask the documentation for."""

import ast
import difflib
import re

import bmesh
import bpy
import mathutils

_NAMED = 12  # names that are told instead of one that is missing
# Building one of these again has no effect beyond reading.
_HARMLESS = (ast.Name, ast.Attribute, ast.Subscript, ast.Constant, ast.Load)


def suspect(error, frame, line, span):  # noqa: PLR0911 - one return a kind of error
    """The query that explains ``error``, or "" where the documentation has nothing to say.

    ``line`` is the source of the line that failed, ``span`` the first and last column of what failed on it.
    """
    words = str(error)
    if isinstance(error, AttributeError) and isinstance(getattr(error, "name", None), str):
        path = _path_of(error.obj)
        return f"{path}.{error.name}" if path else ""
    if _is_missing_key(error):
        return _missing_key(frame, line, span)
    if isinstance(error, TypeError) and "enum" in words and "not found in" in words:
        return f"TypeError: {words[:400]}"
    if isinstance(error, AttributeError) and (called := re.search(r"bpy\.ops\.\w+\.\w+", words)):
        return called[0]
    if isinstance(error, TypeError) and (called := re.search(r"bpy\.ops\.\w+\.\w+", f"{words} {line}")):
        argument = re.search(r'keyword "(\w+)" unrecognized', words)
        return f"{called[0]}({argument[1]})" if argument else f"{called[0]}: TypeError: {words[:300]}"
    if isinstance(error, ValueError) and "execution context is supported" in words:
        return "bpy.types.Context.temp_override"  # a dictionary of overrides was given, as before 4.0
    if isinstance(error, (AttributeError, TypeError, RuntimeError)) and re.search(
        r"bpy|Operator|rna|poll\(\)", words
    ):
        return f"{type(error).__name__}: {words[:400]}"
    return ""


def _path_of(thing):
    """How the documentation calls a value's type; "" for what is not Blender's."""
    kind = thing if isinstance(thing, type) else type(thing)
    if isinstance(thing, type(bpy)):
        name = thing.__name__
        return name if name.split(".")[0] in {"bpy", "bmesh", "mathutils", "gpu", "aud", "bpy_extras"} else ""
    rna = getattr(thing, "bl_rna", None)
    if rna is not None and isinstance(rna, bpy.types.Struct):
        return f"bpy.types.{rna.identifier}"
    for name, module in (("mathutils", mathutils), ("bmesh.types", bmesh.types)):
        if getattr(module, kind.__name__, None) is kind:
            return f"{name}.{kind.__name__}"
    if type(thing).__name__ == "BPyOps" or "BPyOpsSubMod" in type(thing).__name__:
        return f"bpy.ops.{thing}".rstrip(".")
    return ""


def names_there(error, frame, line, span):
    """The names that a collection has instead of the one that was asked for, the nearest first."""
    missed = _missed(frame, line, span) if _is_missing_key(error) else None
    if missed is None:
        return []
    _, node, thing = missed
    try:
        names = list(getattr(thing, node.value.attr).keys())
        wanted = str(ast.literal_eval(node.slice)).lower()
    except Exception:
        return []
    lower = {name.lower(): name for name in reversed(names)}
    near = [lower[name] for name in difflib.get_close_matches(wanted, lower, _NAMED, 0.5)]
    return [*near, *(name for name in names if name not in near)][:_NAMED]


def _is_missing_key(error):
    return isinstance(error, KeyError) and "bpy_prop_collection" in str(error)


def _missing_key(frame, line, span):
    """``ShaderNodeBsdfPrincipled.inputs["Specular"]`` for a socket that a node does not have; other names are the
    file's own."""
    missed = _missed(frame, line, span)
    if missed is None or missed[1].value.attr not in {"inputs", "outputs"}:
        return ""
    path, node, _ = missed
    return f"{path}.{node.value.attr}[{ast.unparse(node.slice)}]"


def _missed(frame, line, span):
    """(path of the owner's type, the subscript, the owner) of the first look-up by name in what failed; or None."""
    source = line.encode()[span[0] : span[1]].decode(errors="replace") if span else line.strip()
    try:
        whole = ast.parse(source.strip(), mode="eval").body
    except (SyntaxError, ValueError):
        return None
    for node in ast.walk(whole):
        if not (isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute)):
            continue
        owner = node.value.value
        if not all(isinstance(part, _HARMLESS) for part in ast.walk(owner)):
            continue
        try:
            source = compile(ast.Expression(owner), "<owner>", "eval")
            thing = eval(source, frame.f_globals, frame.f_locals)  # noqa: S307 - names and attributes alone
            path = _path_of(thing)
        except Exception:
            continue
        if path:
            return path, node, thing
    return None
