# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators under ``bpy.ops``: their arguments with defaults."""

import bpy

from .rna import parameter


def write_all(write):
    """One record an operator, one a module of operators."""
    for module_name in sorted(dir(bpy.ops)):
        module = getattr(bpy.ops, module_name)
        owner = f"bpy.ops.{module_name}"
        write(
            "symbol", path=owner, kind="module", owner="bpy.ops", description=f"Operators of {module_name}."
        )
        for name in sorted(dir(module)):
            rna = getattr(module, name).get_rna_type()
            write(
                "symbol",
                path=f"{owner}.{name}",
                kind="operator",
                owner=owner,
                label=rna.name,
                description=rna.description,
                parameters=[parameter(prop) for prop in rna.properties if prop.identifier != "rna_type"],
                target=rna.identifier,
            )
