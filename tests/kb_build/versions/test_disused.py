"""Properties that are still there and do nothing: which they are, in which versions, and what is said of them."""

from __future__ import annotations

from kb_build.blender.tried_facts import add_fact
from kb_build.symbols.flag_names import BARE_DATA, STUB
from kb_build.symbols.records import Deprecation, Symbol
from kb_build.versions.disused import with_later_ways, with_present_ways, without_effect
from kb_build.versions.successors import load_successors

EEVEE = "bpy.types.SceneEEVEE"
NAMES = (
    "use_bloom",
    "use_ssr",
    "use_gtao",
    "gtao_distance",
    "taa_samples",
    "use_raytracing",
    "fast_gi_method",
)
SYMBOLS = [Symbol(f"{EEVEE}.{name}", "property", EEVEE) for name in NAMES]


def _said(version: str, symbols: list[Symbol] = SYMBOLS) -> dict[str, Deprecation]:
    """Name → what is said of it, for those of which anything is."""
    found = without_effect(symbols, load_successors(), version)
    assert [symbol.path for symbol in found] == [symbol.path for symbol in symbols]
    return {symbol.name: symbol.deprecation for symbol in found if symbol.deprecation}


def test_settings_of_an_engine_that_is_gone_have_no_effect_until_they_go() -> None:
    said = _said("4.2")
    assert set(said) == {"use_bloom", "use_ssr", "use_gtao"}
    assert (said["use_ssr"].since, said["use_ssr"].removal) == ("4.2", "4.3")
    assert said["use_gtao"].removal == "5.0"
    assert (
        said["use_ssr"].note == f"It has no effect. Use `{EEVEE}.use_raytracing`. (release notes 4.2: EEVEE)"
    )
    # What this version lacks is not told: no node is among these symbols.
    assert "ShaderNodeAmbientOcclusion" not in said["use_gtao"].note
    assert "Glare node" in said["use_bloom"].note


def test_they_have_an_effect_before_and_are_gone_after() -> None:
    assert _said("4.1") == {}
    assert set(_said("4.5")) == {"use_gtao"}
    assert _said("5.0") == {}


def test_only_what_went_with_an_engine_is_told_so() -> None:
    # A property that is merely on its way out works until it is gone.
    table = load_successors()
    symbols = [
        Symbol(row.old, "property", row.old.rpartition(".")[0]) for row in table if not {*"(:"} & {*row.old}
    ]
    versions = {row.version for row in table} - {""}
    notes = {one.note for version in versions for one in _said(version, symbols).values()}
    assert notes
    assert {note[note.rindex("(") :] for note in notes} == {"(release notes 4.2: EEVEE)"}


def test_what_blender_says_itself_stays() -> None:
    own = Deprecation("Blender says so.", "4.2", "5.0")
    assert _said("4.2", [Symbol(f"{EEVEE}.use_ssr", "property", EEVEE, deprecation=own)]) == {"use_ssr": own}


def test_an_operator_that_makes_what_is_to_come_names_the_one_of_today() -> None:
    row: dict[str, object] = {"flags": ["compared"]}
    add_fact("bare_data", row, {"path": "bpy.ops.object.grease_pencil_add"})
    assert row["flags"] == ["compared", BARE_DATA]
    bare = Symbol("bpy.ops.object.grease_pencil_add", "operator", flags=("compared", BARE_DATA))
    today = Symbol("bpy.ops.object.gpencil_add", "operator")
    table = load_successors()
    assert with_present_ways([bare, today], table, "4.2")[0].flags == ("compared", f"{BARE_DATA}{today.path}")
    assert with_present_ways([bare], table, "4.2") == [bare]
    assert with_present_ways([bare, today], table, "4.3") == [bare, today]


def test_a_module_of_names_alone_says_what_takes_its_place_later() -> None:
    table = load_successors()
    stubs = [Symbol(f"bgl.{name}", "data", "bgl", flags=(STUB,)) for name in ("glEnable", "glVertexAttrib1s")]
    rest = [Symbol("bgl", "module"), Symbol("bgl.GL_BLEND", "data", "bgl")]
    gpu = [Symbol(path, "module") for path in ("gpu", "gpu.state", "gpu.state.blend_set")]
    found = {one.path: one.deprecation for one in with_later_ways([*stubs, *rest, *gpu], table, "4.2")}
    assert [one for one in gpu if found.pop(one.path)] == []
    assert {one.removal if one else "" for one in found.values()} == {"5.0"}
    enable, blend = found["bgl.glEnable"], found["bgl.GL_BLEND"]
    assert enable
    assert enable.note.startswith("Use `gpu.state.blend_set`.")
    assert blend
    assert blend.note.startswith("Use `gpu`, `gpu.state`. The module bgl was removed")
    # Where it is more than names, nothing is said, and nothing where it is gone.
    assert with_later_ways([*rest, *gpu], table, "4.2") == [*rest, *gpu]
    assert with_later_ways([*stubs, *rest], table, "5.0") == [*stubs, *rest]
