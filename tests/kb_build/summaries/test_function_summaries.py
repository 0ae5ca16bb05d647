"""Sentences on functions of which Blender says nothing: found by what these take, and true in Blender."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.schema import BY_MODEL
from kb_build.summaries.functions import (
    function_digest,
    load_function_summaries,
    with_function_summaries,
)
from kb_build.symbols.records import Parameter, Symbol

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase

DELETE = Symbol(
    "bmesh.ops.delete",
    "function",
    "bmesh.ops",
    parameters=tuple(Parameter(name, "") for name in ("bmesh", "geom", "context")),
)


def test_a_function_without_words_gets_a_sentence_that_says_who_wrote_it() -> None:
    (described,) = with_function_summaries([DELETE])
    assert described.description.startswith(f"{BY_MODEL}Removes geometry.")


@pytest.mark.parametrize(
    "symbol",
    [
        replace(DELETE, description="Blender's own words"),
        replace(DELETE, parameters=DELETE.parameters[:2]),  # of another version
        replace(DELETE, path="bmesh.ops.deleted"),
        replace(DELETE, kind="property"),
    ],
)
def test_what_has_words_or_takes_something_else_gets_none(symbol: Symbol) -> None:
    assert list(with_function_summaries([symbol])) == [symbol]


def test_every_function_of_bmesh_ops_is_described(kb: KnowledgeBase) -> None:
    paths = [entry.path for entry in kb.reader.members("bmesh.ops").values()]
    assert len(paths) > 70
    symbols = [symbol for symbol in map(kb.symbol, paths) if symbol is not None]
    known = load_function_summaries()
    assert [one.path for one in symbols if (one.path, function_digest(one)) not in known] == []
    assert [one.path for one in symbols if not one.description.startswith(BY_MODEL)] == []


# What sentences say that one may be wrong about → an expression that is true if it holds.
TRIED = {
    "create_cube": "size(made('create_cube', size=1)) == (1, 1, 1)",
    "create_grid": "size(made('create_grid', x_segments=3, y_segments=2, size=1)) == (2, 2, 0) "
    "and len(made('create_grid', x_segments=3, y_segments=2, size=1).faces) == 6",
    "create_cone": "size(made('create_cone', segments=8, radius1=1, radius2=1, depth=2)) == (2, 2, 2) "
    "and len(made('create_cone', segments=8, radius1=1, radius2=1, depth=2).faces) == 8",
    "create_icosphere": "[len(made('create_icosphere', subdivisions=n, radius=1).faces) for n in (1, 2)] == [20, 80]",
    "delete": "[faces('delete', geom=some('faces', 1)), faces('delete', geom=some('faces', 1), context='FACES')] "
    "== [6, 5]",
    "extrude_face_region": "after('extrude_face_region', geom=some('faces', 1)) == (12, 20, 11)",  # the old one too
    "extrude_discrete_faces": "faces('extrude_discrete_faces', faces=some('faces', 1)) == 10",
    "smooth_vert": "[size(cube('smooth_vert', verts=some('verts'), factor=0.5, **axes))[0] < 2 "
    "for axes in ({}, {'use_axis_x': True})] == [False, True]",
    "scale": "size(cube('scale', verts=some('verts'))) == (0, 0, 0)",
    "solidify": "[size(cube('solidify', geom=some('faces'), thickness=t))[0] > 2 for t in (0.1, -0.1)] "
    "== [False, True]",
    "subdivide_edges": "[faces('subdivide_edges', edges=some('edges'), cuts=n, use_grid_fill=True) for n in (0, 1)] "
    "== [6, 24]",
    "bisect_plane": "top('bisect_plane', geom=every, plane_no=(0, 0, 1), clear_outer=True) == 0",
    "bisect_edges": "after('bisect_edges', edges=some('edges'), cuts=2) == (32, 36, 6)",
    "bevel": "[faces('bevel', geom=some('edges'), offset=0.2, segments=1, **how) "
    "for how in ({}, {'affect': 'EDGES'})] == [14, 26]",
    "convex_hull": "[faces('convex_hull', input=some('verts'), use_existing_faces=u) for u in (True, False)] "
    "== [6, 18]",
    "find_doubles": "after('find_doubles', verts=some('verts'), dist=9.0) == (8, 12, 6)",
    "region_extend": "after('region_extend', geom=some('verts', 1)) == (8, 12, 6)",
    "split": "after('split', geom=some('faces', 1)) == (12, 16, 6)",
    "split_edges": "after('split_edges', edges=some('edges')) == (24, 24, 6)",
    "inset_region": "top('inset_region', faces=highest, thickness=0.1, depth=0.5) == 1.5",
    "poke": "top('poke', faces=highest, offset=0.5) == 1.5",
    "pointmerge": "after('pointmerge', verts=some('verts', 4), merge_co=(0, 0, 0))[0] == 5",
    "bmesh_to_mesh": "refused('bmesh_to_mesh', mesh=bpy.data.meshes.new('m'))",
    "mesh_to_bmesh": "refused('mesh_to_bmesh', mesh=bpy.data.meshes.new('m'))",
    "object_load_bmesh": "refused('object_load_bmesh', scene=bpy.context.scene)",
}
_TRY = """
import json, sys
import bpy, bmesh

def made(name, **given):
    bm = bmesh.new()
    getattr(bmesh.ops, name)(bm, **given)
    return bm

def some(kind, count=None):
    return lambda bm: list(getattr(bm, kind))[:count]

def every(bm):
    return [*bm.verts, *bm.edges, *bm.faces]

def highest(bm):
    return [max(bm.faces, key=lambda face: face.calc_center_median().z)]

def cube(name, **given):
    bm = made("create_cube", size=2)
    bm.normal_update()
    getattr(bmesh.ops, name)(bm, **{key: one(bm) if callable(one) else one for key, one in given.items()})
    return bm

def size(bm):
    spans = ([v.co[axis] for v in bm.verts] for axis in range(3))
    return tuple(round(max(span) - min(span), 3) for span in spans)

def after(name, **given):
    bm = cube(name, **given)
    return len(bm.verts), len(bm.edges), len(bm.faces)

def faces(name, **given):
    return after(name, **given)[2]

def top(name, **given):
    bm = cube(name, **given)
    return round(max(v.co.z for v in bm.verts), 3)

def refused(name, **given):
    try:
        cube(name, **given)
    except NotImplementedError:
        return True
    return False

tried = json.load(open(sys.argv[-1]))
open(sys.argv[-1], "w").write(json.dumps({name: bool(eval(code)) for name, code in tried.items()}))
"""


def test_what_the_sentences_say_holds_in_blender(tmp_path: Path) -> None:
    said = {path.rpartition(".")[2] for path, _ in load_function_summaries()}
    assert said > TRIED.keys()
    assert told_by_blender(_TRY, tmp_path, TRIED) == dict.fromkeys(TRIED, True)
