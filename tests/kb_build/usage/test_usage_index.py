"""The uses of symbols in all of a Blender's scripts: found in processes apart, kept, and written to the base."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.page import Page, Section
from kb_build.symbols.records import Symbol
from kb_build.usage import usage_index
from kb_build.usage.scripts import Script, blender_scripts
from kb_build.usage.usage_index import page_usage, script_usage, usage_file, with_aliases

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

T = "bpy.types."
SYMBOLS = [
    Symbol("bpy", "module"),
    Symbol("bpy.types", "module", "bpy"),
    Symbol("bpy.context", "data", "bpy", type="Context", target="Context"),
    Symbol(f"{T}Context", "class", "bpy.types"),
    Symbol(f"{T}Object", "class", "bpy.types"),
    Symbol(f"{T}Object.name", "property", f"{T}Object", type="string"),
    Symbol(f"{T}Context.object", "context", f"{T}Context", type="pointer", target="Object"),
    Symbol("bpy.context.object", "context", "bpy.context", flags=(f"same-as:{T}Context.object",)),
]


@pytest.fixture
def scripts(tmp_path: Path) -> list[Script]:
    folder = tmp_path / "scripts"
    for name in (
        "startup/bl_ui/a.py",
        "templates_py/b.py",
        "presets/keyconfig/c.py",
        "presets/e.py",
        "other/d.py",
    ):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("import bpy\nbpy.context.object.name = 'x'\n")
    return list(blender_scripts(folder))


def test_scripts_that_show_how_things_are_done_are_read(scripts: list[Script]) -> None:
    assert [script.name for script in scripts] == ["templates_py/b.py", "startup/bl_ui/a.py", "presets/e.py"]
    assert scripts[0].cost < scripts[1].cost < scripts[2].cost


def test_uses_are_kept_for_the_next_build(
    scripts: list[Script], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = usage_file(tmp_path, "5.1", scripts)
    with script_usage(SYMBOLS, scripts, "5.1.2", file=file, jobs=2) as result:
        first = result()
    assert first.uses[f"{T}Object.name"].count == 3
    assert first.uses[f"{T}Object.name"].examples[0].file == "templates_py/b.py"
    monkeypatch.setattr(usage_index, "analyse", None)
    with script_usage(SYMBOLS, scripts, "5.1.2", file=file, jobs=2) as result:
        assert result() == first


def test_a_damaged_file_is_written_again(scripts: list[Script], tmp_path: Path) -> None:
    file = usage_file(tmp_path, "5.1", scripts)
    file.parent.mkdir()
    file.write_bytes(gzip.compress(b"[")[:9])
    with script_usage(SYMBOLS, scripts, "5.1.2", file=file, jobs=1) as result:
        first = result()
    assert first.uses
    with script_usage(SYMBOLS, scripts, "5.1.2", file=file, jobs=1) as result:
        assert result() == first


def test_where_nothing_can_be_kept_the_uses_are_found_all_the_same(
    scripts: list[Script], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("in the way")
    with script_usage(SYMBOLS, scripts, "5.1.2", file=tmp_path / "file" / "x.json.gz", jobs=1) as result:
        assert f"{T}Object.name" in result().uses


def test_the_name_of_the_file_follows_from_all_that_shapes_it(scripts: list[Script], tmp_path: Path) -> None:
    names = {usage_file(tmp_path, "5.1", scripts), usage_file(tmp_path, "5.2", scripts)}
    scripts[0].path.write_text("import bpy\n")
    assert len(names | {usage_file(tmp_path, "5.1", scripts)}) == 3


def test_the_code_of_guides_is_read() -> None:
    code = "Set it:\n\n```python\nimport bpy\nbpy.context.object.name = 'x'\n```\n\nDone."
    guide = Page("info_x", "guide", "5.1", "X", (Section("", "X", 1, code),))
    manual = Page("x", "manual", "5.1", "X", (Section("", "X", 1, code),))
    found = page_usage(SYMBOLS, [guide, manual], "5.1")
    assert found[f"{T}Object.name"].count == 1
    assert found[f"{T}Object.name"].examples[0].file == "info_x"


def test_context_members_have_two_names() -> None:
    code = "```python\nimport bpy\nbpy.context.object\n```"
    found = page_usage(SYMBOLS, [Page("x", "guide", "5.1", "X", (Section("", "X", 1, code),))], "5.1")
    both = with_aliases(found, SYMBOLS)
    assert both["bpy.context.object"] == both[f"{T}Context.object"]


# Of Blender itself


def test_blenders_own_scripts_are_in_the_base(reader: BaseReader) -> None:
    counts = reader.usage.use_counts(
        [f"{T}Object.location", f"{T}UILayout.prop", "bpy.context.object", f"{T}Object.no"]
    )
    assert counts[f"{T}UILayout.prop"] > counts[f"{T}Object.location"] > 20
    assert f"{T}Object.no" not in counts
    uses = reader.usage.uses(f"{T}Object.location")
    assert len(uses) == 3
    assert all("location" in use.code and use.file.endswith(".py") and use.line > 0 for use in uses)
    # Only presets set it, on a member of the context that a panel gives.
    assert not reader.usage.uses(f"{T}ClothSettings.quality")


def test_most_symbols_that_scripts_use_have_an_example(reader: BaseReader) -> None:
    rows = reader.rows(
        "SELECT path, (SELECT count(*) FROM uses WHERE uses.path = use_counts.path) FROM use_counts "
        "ORDER BY uses DESC, path LIMIT 1000"
    )
    assert len(rows) == 1000
    assert sum(shown > 0 for _, shown in rows) >= 800


def test_an_answer_shows_the_clearest_use(kb: KnowledgeBase, reader: BaseReader) -> None:
    use = reader.usage.uses("bpy.ops.mesh.primitive_cube_add")[0]
    text = kb.query("bpy.ops.mesh.primitive_cube_add", max_tokens=4_000).text
    assert f"**Used** ({use.file}:{use.line})\n```python\n{use.code}\n```" in text
