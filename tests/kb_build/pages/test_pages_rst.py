"""RST sources become pages, through Sphinx, whatever state they are in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_build.errors import SourceError
from kb_build.pages.readers.rst import read_rst

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.pages.page import Page

MINI = REPO / "tests" / "corpora_mini"


@pytest.fixture(scope="module")
def manual() -> dict[str, Page]:
    return {page.slug: page for page in read_rst(MINI / "manual", source="manual", version="5.1")}


@pytest.fixture(scope="module")
def guides() -> dict[str, Page]:
    return {page.slug: page for page in read_rst(MINI / "guides", source="guide", version="5.1")}


def read_one(folder: Path, text: str, *, name: str = "page") -> Page:
    (folder / f"{name}.rst").write_text(text, encoding="utf-8")
    pages = read_rst(folder, source="manual", version="5.1", jobs=1)
    return next(page for page in pages if page.slug == name)


def test_every_source_file_is_a_page_under_its_slug(manual: dict[str, Page]) -> None:
    files = {
        path.relative_to(MINI / "manual").with_suffix("").as_posix() for path in MINI.glob("manual/**/*.rst")
    }
    assert manual.keys() == files


def test_addresses_are_those_of_the_published_documentation(
    manual: dict[str, Page], guides: dict[str, Page]
) -> None:
    cloth = manual["physics/cloth/settings/index"]
    assert cloth.url == "https://docs.blender.org/manual/en/5.1/physics/cloth/settings/index.html"
    assert guides["info_traps"].url == "https://docs.blender.org/api/5.1/info_traps.html"


def test_breadcrumbs_follow_the_tables_of_contents_without_the_front_page(manual: dict[str, Page]) -> None:
    assert manual["physics/cloth/settings/collisions"].breadcrumbs == ("Physics", "Cloth", "Settings")
    assert manual["physics/index"].breadcrumbs == ()
    assert manual["index"].breadcrumbs == ()


def test_children_come_in_order_from_shown_hidden_and_globbed_tables_of_contents(
    manual: dict[str, Page],
) -> None:
    shown = ("modeling/index", "physics/index", "glossary/index")
    assert manual["index"].children == (*shown, "interface/keys", "troubleshooting/index")
    assert manual["modeling/modifiers/index"].children == ("modeling/modifiers/generate/subdivision_surface",)


def test_tables_of_contents_do_not_clutter_the_text(manual: dict[str, Page]) -> None:
    assert manual["physics/index"].sections[0].text == ""


def test_sections_keep_document_order_levels_and_anchors(manual: dict[str, Page]) -> None:
    page = manual["physics/rigid_body/introduction"]
    outline = [(section.level, section.title, section.anchor) for section in page.sections]
    assert outline == [(1, "Introduction", "introduction"), (2, "Options", "options"), (2, "Options", "id1")]


def test_addresses_of_symbols_are_kept_with_the_line_that_they_lead_to(manual: dict[str, Page]) -> None:
    section = manual["physics/cloth/settings/index"].sections[0]
    places = {name: section.text.split("\n")[line] if line >= 0 else "" for name, line in section.marks}
    assert places == {"bpy-types-clothsettings": "", "bpy-types-clothsettings-quality": "**Quality Steps**"}


def test_property_descriptions_stay_definitions(manual: dict[str, Page]) -> None:
    text = manual["physics/cloth/settings/index"].text
    assert "**Quality Steps**\n  How many times each frame is solved." in text


def test_enum_values_stay_a_list_inside_their_property(manual: dict[str, Page]) -> None:
    text = manual["modeling/modifiers/generate/subdivision_surface"].text
    assert "**Type**\n  - **Catmull-Clark:** Cuts and rounds.\n  - **Simple:** Only cuts" in text


def test_the_reference_box_keeps_mode_panel_and_shortcut(manual: dict[str, Page]) -> None:
    text = manual["physics/cloth/settings/index"].text
    box = "> **Reference:**\n> - **Mode:** Object Mode\n> - **Panel:** Physics ‣ Cloth\n"
    assert box + "> - **Shortcut:** `Ctrl-Alt-C`" in text


def test_icons_leave_neither_marks_nor_empty_brackets(manual: dict[str, Page]) -> None:
    text = manual["physics/cloth/settings/index"].text
    assert "**Weight**\n" in text
    assert "**Presets**\n" in text


def test_notes_nested_lists_and_tables_survive(manual: dict[str, Page]) -> None:
    introduction = manual["physics/cloth/introduction"].text
    assert "> **Tip:** Simulate with a coarse mesh" in introduction
    assert "> - a smoother look.\n>   1. Add the cloth.\n>   2. Add the modifier *behind* it." in introduction
    surface = manual["modeling/modifiers/generate/subdivision_surface"].text
    assert "| Level | Faces | Remark |\n| --- | --- | --- |\n| 1 | 24 | fast \\| smooth |" in surface
    assert "| CPU | 1 |\n|  | 2 |" in surface


def test_pictures_become_their_captions(manual: dict[str, Page]) -> None:
    text = manual["modeling/modifiers/generate/subdivision_surface"].text
    assert "Figure: A cube, subdivided *twice*.\n\nThe wire shows the original." in text
    assert "subdivided_cube" not in text


def test_code_formulas_and_options_are_kept(manual: dict[str, Page]) -> None:
    assert (
        '```python\ncloth = bpy.context.object.modifiers["Cloth"]\n'
        in manual["physics/cloth/settings/collisions"].text
    )
    assert (
        "$$\n  f_n = f_0 \\cdot 4^n\n  $$" in manual["modeling/modifiers/generate/subdivision_surface"].text
    )
    assert "**`-b, --background`**\n  Without a window." in manual["physics/rigid_body/introduction"].text


def test_cross_references_show_titles_and_are_listed_as_links(manual: dict[str, Page]) -> None:
    page = manual["physics/cloth/introduction"]
    assert "See the settings and Quality Steps; stiff bodies are simulated as Introduction." in page.text
    assert page.links == (
        "physics/cloth/settings/index",
        "physics/rigid_body/introduction",
        "modeling/modifiers/generate/subdivision_surface",
    )
    assert "[Springs](https://example.org/springs?n=1)" in page.text


def test_terms_lead_to_the_glossary(manual: dict[str, Page]) -> None:
    assert manual["physics/cloth/settings/index"].links == ("glossary/index",)
    assert "**Active**\n**Current**\n  The object selected last." in manual["glossary/index"].text


def test_the_version_stands_where_the_manual_puts_it(manual: dict[str, Page]) -> None:
    assert manual["index"].title == "Miniature 5.1 Handbook"


def test_only_what_is_meant_for_html_is_read(manual: dict[str, Page]) -> None:
    assert "read in a browser" in manual["index"].text
    assert "printed" not in manual["index"].text


def test_films_are_dropped_and_included_files_are_not(manual: dict[str, Page]) -> None:
    assert "00000000" not in manual["physics/cloth/introduction"].text
    assert "changed in the preferences" in manual["interface/keys"].text


def test_sound_pages_carry_no_warnings(manual: dict[str, Page], guides: dict[str, Page]) -> None:
    pages = {**manual, **guides}
    assert [slug for slug in pages if pages[slug].warnings] == [
        "troubleshooting/malformed",
        "troubleshooting/unknown",
    ]


def test_a_malformed_page_is_kept_whole_with_warnings(manual: dict[str, Page]) -> None:
    page = manual["troubleshooting/malformed"]
    assert page.title == "Malformed"
    for part in ("broken, see nowhere and /not/there", ".. list-table::", "| no |", "The end is still read."):
        assert part in page.text
    assert "line 16: Malformed table. Bottom border missing or corrupt." in page.warnings
    assert "line 5: unknown document: '/not/there'" in page.warnings


def test_unknown_directives_and_roles_keep_their_content_with_a_warning(manual: dict[str, Page]) -> None:
    page = manual["troubleshooting/unknown"]
    assert "Linux\n\nInstall it with the **package manager**.\n\nWindows\n\nRun the installer." in page.text
    assert "Press OK and Go." in page.text
    assert "line 5: unknown directive 'tabs': its content is kept as plain text" in page.warnings
    assert "line 16: unknown role 'sparkle': its text is kept" in page.warnings


def test_guides_without_a_front_page_have_titles_code_and_breadcrumbs(guides: dict[str, Page]) -> None:
    assert guides["info_traps"].breadcrumbs == ("Overview",)
    assert guides["info_overview"].breadcrumbs == ()
    assert (
        "`bpy.data`, e.g. `bpy.types.Mesh`, and call `bpy.ops.object.add()`" in guides["info_overview"].text
    )


def test_references_into_other_documentation_keep_the_name_alone(guides: dict[str, Page]) -> None:
    assert "See the manual's command-line and `bpy.types.Mesh`." in guides["info_overview"].text


def test_two_processes_read_what_one_reads(tmp_path: Path) -> None:
    for number in range(60):
        label = f".. _label-{number}:\n\n"
        text = f"{label}Page {number}\n=======\n\n:ref:`label-{(number + 7) % 60}` :oops:`here`\n"
        (tmp_path / f"page_{number}.rst").write_text(text)
    one = read_rst(tmp_path, source="manual", version="5.1", jobs=1)
    two = read_rst(tmp_path, source="manual", version="5.1", jobs=2)
    assert one == two
    assert len(two) == 60
    assert two[0].warnings == ("line 6: unknown role 'oops': its text is kept",)


def test_what_a_page_has_is_found_whatever_the_pages_before_it_had(tmp_path: Path) -> None:
    texts = {
        "a": "Plain\n=====\n\nText.\n",
        "b": "Noted\n=====\n\nText [#]_ of |version|.\n\n.. [#] A note.\n",
        "c": "Other\n=====\n\n- See :doc:`b`.\n\n.. code-block:: none\n\n   code\n",
        "d": "Again\n=====\n\nText [#]_ of |version|.\n\n.. [#] Another note.\n",
    }
    alone: dict[str, Page] = {}
    (all_of_them := tmp_path / "together").mkdir()
    for slug, text in texts.items():
        (folder := tmp_path / slug).mkdir()
        alone[slug] = read_one(folder, text, name=slug)
        (all_of_them / f"{slug}.rst").write_text(text, encoding="utf-8")
    together = {page.slug: page for page in read_rst(all_of_them, source="manual", version="5.1", jobs=1)}
    for slug in ("a", "b", "d"):
        assert together[slug].sections == alone[slug].sections
    assert "See Noted" in together["c"].sections[0].text


def test_progress_counts_up_to_the_whole(tmp_path: Path) -> None:
    for number in range(45):
        (tmp_path / f"page_{number}.rst").write_text(f"Page {number}\n=======\n")
    seen: list[tuple[int, int]] = []
    read_rst(
        tmp_path, source="manual", version="5.1", jobs=2, progress=lambda done, of: seen.append((done, of))
    )
    assert seen[-1] == (90, 90)
    assert seen == sorted(seen)


def test_nothing_is_written_into_the_sources() -> None:
    before = {path: path.stat().st_mtime_ns for path in sorted(MINI.rglob("*"))}
    read_rst(MINI / "manual", source="manual", version="5.1", jobs=1)
    assert {path: path.stat().st_mtime_ns for path in sorted(MINI.rglob("*"))} == before


def test_a_configuration_that_comes_with_the_sources_is_not_run(tmp_path: Path) -> None:
    trace = tmp_path / "trace"
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "conf.py").write_text(f"open({str(trace)!r}, 'w').close()")
    read_one(tmp_path / "sources", "Page\n====\n")
    assert not trace.exists()


def test_a_page_has_no_module_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    modules = tmp_path / "modules"
    modules.mkdir()
    (modules / "named_by_a_page.py").write_text("print('imported', flush=True)")
    monkeypatch.syspath_prepend(modules)
    sources = tmp_path / "sources"
    sources.mkdir()
    (sources / "other.txt").write_text("Other words.\n")
    text = "Page\n====\n\n.. include:: other.txt\n   :parser: named_by_a_page\n\n.. include:: other.txt\n"
    page = read_one(sources, text)
    assert "imported" not in capfd.readouterr().out
    assert page.text.count("Other words.") == 1
    assert page.warnings == ('line 4: Error in "include" directive: unknown option: "parser".',)


def test_files_outside_the_sources_are_never_read(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("swordfish")
    sources = tmp_path / "sources"
    sources.mkdir()
    text = (
        "Page\n====\n\n.. include:: ../secret.txt\n\n.. literalinclude:: ../secret.txt\n\n"
        f".. include:: <{tmp_path}/secret.txt>\n\n.. csv-table::\n   :file: ../secret.txt\n\n"
        ".. raw:: html\n   :file: ../secret.txt\n\nThe end.\n"
    )
    page = read_one(sources, text)
    assert "swordfish" not in page.text
    assert "The end." in page.text
    assert "line 4: '../secret.txt' is outside the sources and was not read" in page.warnings


def test_a_long_page_is_not_cut(tmp_path: Path) -> None:
    words = " ".join(f"word{number}" for number in range(5_000))
    page = read_one(tmp_path, f"Page\n====\n\n{words}\n")
    assert page.sections[0].text == words


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        pytest.param(
            "Page\n====\n\n" + "".join(f"{'  ' * n}- x{n}\n\n" for n in range(400)), "x399", id="deep"
        ),
        pytest.param("Page\n====\n\n" + "x" * 150_000, "x" * 150_000, id="endless line"),
    ],
)
def test_a_page_that_the_parser_gives_up_on_is_kept_as_plain_text(
    tmp_path: Path, text: str, kept: str
) -> None:
    page = read_one(tmp_path, text)
    assert page.title == "Page"
    assert kept in page.text
    assert "kept as plain text" in page.warnings[0]


@pytest.mark.slow
def test_substitutions_that_multiply_are_stopped(tmp_path: Path) -> None:
    bomb = "".join(f".. |b{n}| replace:: {f'|b{n - 1}| ' * 10 if n else 'boom'}\n" for n in range(10))
    page = read_one(tmp_path, f"Page\n====\n\n|b9|\n\n{bomb}")
    assert len(page.text) < 200_000
    assert "exceeds the line-length-limit" in page.warnings[0]


def test_a_page_in_another_encoding_is_kept_with_a_warning_and_spares_the_others(tmp_path: Path) -> None:
    (tmp_path / "broken.rst").write_bytes("Café\n====\n\nSee :doc:`page`.\n".encode("latin-1"))
    page = read_one(tmp_path, "Page\n====\n\nSee :doc:`broken`.\n")
    broken = next(p for p in read_rst(tmp_path, source="manual", version="5.1") if p.slug == "broken")
    assert broken.title == "Caf\ufffd"
    assert broken.links == ("page",)
    assert broken.warnings == ("not UTF-8: undecodable characters were replaced",)
    assert page.warnings == ()
    assert (tmp_path / "broken.rst").read_bytes().startswith(b"Caf\xe9")


@pytest.mark.parametrize("text", ["", "\n \n", "\x00\x01\x02", "====\n"])
def test_a_page_without_content_has_a_title_from_its_slug(tmp_path: Path, text: str) -> None:
    page = read_one(tmp_path, text, name="edge_split")
    assert page.title == "Edge Split"
    assert len(page.sections) == 1


def test_text_before_the_title_belongs_to_the_first_section(tmp_path: Path) -> None:
    page = read_one(tmp_path, ".. note:: Early.\n\nPage\n====\n\nLate.\n")
    assert page.sections[0].text == "> **Note:** Early.\n\nLate."


def test_tables_of_contents_in_a_circle_do_not_hang(tmp_path: Path) -> None:
    (tmp_path / "a.rst").write_text("A\n=\n\n.. toctree::\n\n   b\n")
    (tmp_path / "b.rst").write_text("B\n=\n\n.. toctree::\n\n   a\n")
    pages = read_rst(tmp_path, source="manual", version="5.1")
    assert [(page.slug, page.children) for page in pages] == [("a", ("b",)), ("b", ("a",))]
    assert {len(page.breadcrumbs) for page in pages} <= {0, 1}


def test_a_folder_without_sources_is_named_in_the_error(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"holds no \.rst files"):
        read_rst(tmp_path, source="manual", version="5.1")
