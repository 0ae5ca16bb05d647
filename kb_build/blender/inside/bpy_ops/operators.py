# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators under ``bpy.ops``: their arguments with defaults."""

import ast
import inspect
import textwrap

import _bpy
import bpy

from ..classes.rna import parameter
from ..instances.assigning import refused_items

OPERATORS = "ops"  # the module of bpy
REFUSED = "\x01"
NOTHING_SAID = "(undocumented operator)"  # what Blender puts in a description's place


def operator_names():
    """Module → the names of its operators, both sorted: who asks module by module has Blender list all each time."""
    found = {}
    for identifier in _bpy.ops.dir():
        module, _, name = identifier.partition("_OT_")
        if name:
            found.setdefault(module.lower(), []).append(name)
    return {module: sorted(found[module]) for module in sorted(found)}


def names_in_file():
    """The names of all data-blocks, and of the keying sets of scenes."""
    kinds = [prop.identifier for prop in bpy.data.bl_rna.properties if prop.type == "COLLECTION"]
    blocks = {block.name for kind in kinds for block in getattr(bpy.data, kind)}
    return blocks.union(*(scene.keying_sets.keys() for scene in bpy.data.scenes))


def values_asked(operator, prop):
    """The values of an argument of which RNA lists one at most, as Blender names them when it refuses another.

    It does so before anything runs, where the context lets the operator run. Where one of them is the name of something
    in the file, all of them are, and none is told.
    """
    if prop.type != "ENUM" or len(prop.enum_items) > 1:
        return []
    try:
        operator(**{prop.identifier: {REFUSED} if prop.is_enum_flag else REFUSED})
    except TypeError as refusal:
        values = refused_items(refusal)
        return values if len(values) > 1 and names_in_file().isdisjoint(values) else []
    except RuntimeError:
        pass
    return []


def argument(operator, prop):
    """One argument of an operator, in the terms of ``records.Parameter``."""
    row, values = parameter(prop), values_asked(operator, prop)
    return {**row, "values_asked": values} if values else row


def calls_in(source):
    """The paths of the operators that a class's source calls where it finds itself, in their order."""
    found = {}
    if OPERATORS not in source:
        return []
    for node in ast.walk(ast.parse(textwrap.dedent(source))):
        if isinstance(node, ast.Attribute) and node.attr == "temp_override":
            return []
        if isinstance(node, ast.Call):
            path = ast.unparse(node.func)
            if path.startswith(f"bpy.{OPERATORS}.") and path.count(".") == 3:
                found[path] = None
    return list(found)


def write_calls(write, path, identifier):
    """One ``operator_calls`` record for an operator in Python that calls others."""
    cls = getattr(bpy.types, identifier, None)
    try:
        called = calls_in(inspect.getsource(cls)) if cls is not None else []
    except (OSError, TypeError, SyntaxError):
        return  # written in C, or its file is not there
    if called:
        write("operator_calls", path=path, calls=called)


def write_all(write):
    """One record an operator, one a module of operators."""
    for module_name, names in operator_names().items():
        module = getattr(bpy.ops, module_name)
        owner = f"bpy.ops.{module_name}"
        write(
            "symbol", path=owner, kind="module", owner="bpy.ops", description=f"Operators of {module_name}."
        )
        for name in names:
            operator = getattr(module, name)
            rna = operator.get_rna_type()
            write(
                "symbol",
                path=f"{owner}.{name}",
                kind="operator",
                owner=owner,
                label=rna.name,
                description=rna.description.replace(NOTHING_SAID, ""),
                parameters=[
                    argument(operator, prop) for prop in rna.properties if prop.identifier != "rna_type"
                ],
                target=rna.identifier,
            )
            write_calls(write, f"{owner}.{name}", rna.identifier)
