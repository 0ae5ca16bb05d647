"""Names in descriptions that no class has."""

from __future__ import annotations

import pytest

from kb_build.blender.references import with_true_references
from kb_build.symbols.records import Symbol


@pytest.mark.parametrize(
    ("named", "meant"),
    [
        ("bpy.types.Mesh.islands", "extras.islands"),  # the only one of that name
        ("bpy.types.Mesh.update", "bpy.types.Mesh.update"),  # is there
        ("bpy.types.Mesh.remove", "bpy.types.Mesh.remove"),  # several have it
        ("bpy.types.Mesh.gone", "bpy.types.Mesh.gone"),  # none has it
    ],
)
def test_a_name_that_leads_nowhere_becomes_the_only_one_that_is_meant(named: str, meant: str) -> None:
    paths = ("extras.islands", "bpy.types.Mesh.update", "a.remove", "b.remove")
    symbols = {path: Symbol(path, "function", path.rpartition(".")[0]) for path in paths}
    symbols["told"] = Symbol("told", "function", "", description=f"Use `{named}` instead.")
    assert with_true_references(symbols)["told"].description == f"Use `{meant}` instead."
