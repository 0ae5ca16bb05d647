# SPDX-License-Identifier: GPL-3.0-or-later
"""Which part of Blender's API an error is about: the query for the documentation."""

import ast
import difflib
import re

import bmesh
import bpy
import mathutils

_LISTED = 12  # existing names that are listed for a missing one
# Evaluating an expression of only these again has no side effects.
_SIDE_EFFECT_FREE = (ast.Name, ast.Attribute, ast.Subscript, ast.Constant, ast.Load)


def documentation_query(error, frame, line, span):  # noqa: PLR0911 - one return for each kind of error
    """The query that explains ``error``, or "" where the documentation has nothing to say.

    ``line`` is the source of the line that failed, ``span`` the first and last column of what failed on it.
    """
    words = str(error)
    if isinstance(error, AttributeError) and isinstance(getattr(error, "name", None), str):
        path = _documented_name(error.obj)
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
        return "bpy.types.Context.temp_override"  # the code passed a dictionary of overrides, as before 4.0
    if isinstance(error, (AttributeError, TypeError, RuntimeError)) and re.search(
        r"bpy|Operator|rna|poll\(\)", words
    ):
        return f"{type(error).__name__}: {words[:400]}"
    return ""


def _documented_name(value):
    """The documentation's name of a value's type or module; "" if it is not Blender's."""
    kind = value if isinstance(value, type) else type(value)
    if isinstance(value, type(bpy)):
        name = value.__name__
        return name if name.split(".")[0] in {"bpy", "bmesh", "mathutils", "gpu", "aud", "bpy_extras"} else ""
    rna = getattr(value, "bl_rna", None)
    if rna is not None and isinstance(rna, bpy.types.Struct):
        return f"bpy.types.{rna.identifier}"
    for name, module in (("mathutils", mathutils), ("bmesh.types", bmesh.types)):
        if getattr(module, kind.__name__, None) is kind:
            return f"{name}.{kind.__name__}"
    if type(value).__name__ == "BPyOps" or "BPyOpsSubMod" in type(value).__name__:
        return f"bpy.ops.{value}".rstrip(".")
    return ""


def existing_names(error, frame, line, span):
    """The names that a collection has, the nearest to the missing one first; [] for other errors."""
    lookup = _failed_lookup(frame, line, span) if _is_missing_key(error) else None
    if lookup is None:
        return []
    _, node, owner_value = lookup
    try:
        names = list(getattr(owner_value, node.value.attr).keys())  # pyright: ignore[reportAttributeAccessIssue]
        wanted = str(ast.literal_eval(node.slice)).lower()
    except Exception:
        return []
    lower = {name.lower(): name for name in reversed(names)}
    near = [lower[name] for name in difflib.get_close_matches(wanted, lower, _LISTED, 0.5)]
    return [*near, *(name for name in names if name not in near)][:_LISTED]


def _is_missing_key(error):
    return isinstance(error, KeyError) and "bpy_prop_collection" in str(error)


def _missing_key(frame, line, span):
    """``ShaderNodeBsdfPrincipled.inputs["Specular"]`` for a socket that a node does not have; "" for names of the
    user's own."""
    lookup = _failed_lookup(frame, line, span)
    if lookup is None or lookup[1].value.attr not in {"inputs", "outputs"}:  # pyright: ignore[reportAttributeAccessIssue]
        return ""
    path, node, _ = lookup
    return f"{path}.{node.value.attr}[{ast.unparse(node.slice)}]"  # pyright: ignore[reportAttributeAccessIssue]


def _failed_lookup(frame, line, span):
    """(path of the owner's type, the subscript, the owner) of the first look-up by name that failed; or None."""
    source = line.encode()[span[0] : span[1]].decode(errors="replace") if span else line.strip()
    try:
        whole = ast.parse(source.strip(), mode="eval").body
    except (SyntaxError, ValueError):
        return None
    for node in ast.walk(whole):
        if not (isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute)):
            continue
        owner = node.value.value
        if not all(isinstance(part, _SIDE_EFFECT_FREE) for part in ast.walk(owner)):
            continue
        try:
            source = compile(ast.Expression(owner), "<owner>", "eval")
            owner_value = eval(source, frame.f_globals, frame.f_locals)  # noqa: S307 - names and attributes alone
            path = _documented_name(owner_value)
        except Exception:
            continue
        if path:
            return path, node, owner_value
    return None
