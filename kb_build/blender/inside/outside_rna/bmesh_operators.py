# SPDX-License-Identifier: GPL-3.0-or-later
"""Types and values of the keywords of ``bmesh.ops``, which its docstrings only name.

Every keyword is given a value of a class that Blender does not know. The operator refuses it before it does
anything, and its message names the type it wants. The mesh is a scratch one with a single vertex.
"""

import re

import bmesh

KEYWORD = re.compile(r"(\w+)=")
WANTED = (
    ("expected a float", "float"), ("expected an int", "int"), ("expected True/False", "bool"),
    ("expected a mathutils.Matrix", "Matrix"),
)  # fmt: skip
NOT_GIVEN = ("not working yet", "is not supported")
UNUSABLE = "Python cannot pass this keyword: every value raises NotImplementedError."
ELEMENTS = re.compile(r"expected (?:an? )?\(((?:BM\w+/?)+)\)")
NO_VALUE = "?"  # in no enumeration
LENGTH = re.compile(r"sequence length is \d+, expected (\d+)")
VALUES = re.compile(r"not found in \(\[?(.*?)\]?\)$", re.DOTALL)


class Unknown:
    """A value that fits no keyword."""


def refusal(operator, mesh, keyword, value):
    """What the operator says of a value that it cannot take; empty if it took it."""
    try:
        operator(mesh, **{keyword: value})
    except Exception as error:
        return str(error)
    return ""


def elements(message):
    """``(BMVert/BMEdge)`` in a message → ``"BMVert | BMEdge"``."""
    match = ELEMENTS.search(message)
    return match[1].replace("/", " | ") if match else ""


def values(message):
    """The allowed strings that a message lists."""
    match = VALUES.search(message)
    return re.findall(r"'([^']+)'", match[1]) if match else []


def generic(name, inner):
    """``list[int]``; just ``list`` where it is not known of what."""
    return f"{name}[{inner}]" if inner else name


def mapping(message):
    """The type of a keyword that wants a dictionary, from what it says of a wrong value for a vertex."""
    for word in ("float", "int", "bool"):
        if f"with {word} values" in message:
            return f"dict[BMVert | BMEdge | BMFace, {word}]"
    kind = elements(message)
    return f"dict[BMVert | BMEdge | BMFace, {kind}]" if kind else ""


def set_of(ask):
    """(type, values) of a keyword that wants a set: of strings, or of elements."""
    if allowed := values(ask({NO_VALUE})):
        return "set[enum]", allowed
    return generic("set", elements(ask({Unknown()}))), []


def keyword_parameter(operator, mesh, vertex, keyword):
    """One keyword in the terms of ``records.Parameter``; without a type where the messages do not tell."""

    def ask(value):
        return refusal(operator, mesh, keyword, value)

    message = ask(Unknown())
    kind, allowed = next((word for text, word in WANTED if text in message), ""), []
    if "expected a string" in message:
        allowed = values(ask(NO_VALUE))
        kind = "enum" if allowed else "str"
    elif "expected a bmesh sequence, list" in message:
        kind = generic("Sequence", elements(ask([Unknown()])))
    elif "expected a dict" in message:
        message = ask({vertex: Unknown()})
        kind = mapping(message)
    elif "expected a set" in message:
        kind, allowed = set_of(ask)
    elif "single element" in message:
        kind = elements(message)
    elif not kind and (length := LENGTH.search(ask(()))):
        kind = f"float[{length[1]}]"
    row = {"name": keyword, "type": kind}
    if allowed:
        row["enum_items"] = [{"identifier": value} for value in allowed]
    if any(text in message for text in NOT_GIVEN):
        row["description"] = UNUSABLE
    return row


def mesh_parameter(operator):
    """The first argument, which has no default; a list of one. Empty if the operator asks for something else."""
    match = re.search(r"\((\w+)[,)]", operator.__doc__ or "")
    try:
        operator(Unknown())
    except TypeError as error:
        if match and "BMesh positional argument" in str(error):
            return [{"name": match[1], "type": "BMesh", "required": True}]
    return []


def parameters(operator):
    """The arguments of one operator, in the terms of ``records.Parameter``."""
    mesh = bmesh.new()
    try:
        vertex = mesh.verts.new()
        keywords = KEYWORD.findall((operator.__doc__ or "").partition("->")[0])
        rows = [keyword_parameter(operator, mesh, vertex, keyword) for keyword in keywords]
        return mesh_parameter(operator) + rows
    finally:
        mesh.free()
