"""HTML pages become the same pages as their RST sources, and whatever else is met is kept."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING

import pytest
from places import REPO
from sphinx.application import Sphinx
from sphinx.util.docutils import docutils_namespace, patch_docutils

from kb_build.errors import SourceError
from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from measurements.reader_comparison import compare

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.pages.page import Page

MINI = REPO / "tests" / "corpora_mini"
FAULTY = {"troubleshooting/malformed", "troubleshooting/unknown"}


def build(sources: Path, out: Path, root: str) -> Path:
    """The sources as Sphinx itself publishes them, in a theme laid out like the official one."""
    versions = ("BLENDER_VERSION", "BLENDER_VERSION_LABEL")
    with patch_docutils(), docutils_namespace():
        app = Sphinx(
            srcdir=sources,
            confdir=None,
            outdir=out / "html",
            doctreedir=out / "trees",
            buildername="html",
            confoverrides={
                "extensions": ["kb_build.pages.readers.blender_markup"],
                "html_theme": "theme",
                "html_theme_path": [str(MINI)],
                "html_copy_source": False,
                "root_doc": root,
                "highlight_language": "python3",
                "locale_dirs": [],
                "rst_prolog": "".join(f".. |{name}| replace:: 5.1\n" for name in versions),
            },
            status=None,
            warning=StringIO(),
            freshenv=True,
            tags=["builder_html"],
        )
        app.build()
    return out / "html"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(MINI / "manual", tmp_path_factory.mktemp("site"), "index")


@pytest.fixture(scope="module")
def from_html(site: Path) -> list[Page]:
    return read_html(site, source="manual", version="5.1")


@pytest.fixture(scope="module")
def from_rst() -> list[Page]:
    return read_rst(MINI / "manual", source="manual", version="5.1")


def read_article(folder: Path, article: str) -> Page:
    (folder / "page.html").write_text(
        f"<html><body><nav>menu</nav><article role='main'>{article}</article></body>"
    )
    return read_html(folder, source="manual", version="5.1", jobs=1)[0]


def test_both_forms_of_a_documentation_give_equal_pages(from_html: list[Page], from_rst: list[Page]) -> None:
    def sound(pages: list[Page]) -> list[Page]:
        # A page whose title is malformed has no entry in a published table of contents.
        return [page for page in pages if not page.slug.startswith("troubleshooting/")]

    assert sound(from_html) == sound(from_rst)
    assert len(sound(from_rst)) == 13


def test_generated_pages_are_left_out(site: Path, from_html: list[Page]) -> None:
    assert (site / "search.html").is_file()
    assert (site / "genindex.html").is_file()
    assert not {"search", "genindex"} & {page.slug for page in from_html}


def test_guides_are_picked_out_of_the_api_reference(tmp_path: Path) -> None:
    site = build(MINI / "guides", tmp_path, "info_overview")
    (site / "bpy.types.Mesh.html").write_text("<article><h1>Mesh</h1></article>")
    guides = read_html(site, source="guide", version="5.1")
    assert guides == read_rst(MINI / "guides", source="guide", version="5.1")


def test_hidden_tables_of_contents_are_found_in_the_sidebar(from_html: list[Page]) -> None:
    index = next(page for page in from_html if page.slug == "index")
    assert index.children[-2:] == ("interface/keys", "troubleshooting/index")


def test_two_processes_read_what_one_reads(tmp_path: Path) -> None:
    for number in range(90):
        (tmp_path / f"page_{number}.html").write_text(f"<article><h1>Page {number}</h1><p>Text.</article>")
    seen: list[tuple[int, int]] = []
    two = read_html(
        tmp_path, source="manual", version="5.1", jobs=2, progress=lambda done, of: seen.append((done, of))
    )
    assert two == read_html(tmp_path, source="manual", version="5.1", jobs=1)
    assert seen[-1] == (90, 90)


def test_typographic_quotes_and_dashes_become_what_people_type(tmp_path: Path) -> None:
    page = read_article(tmp_path, "<h1>Don’t</h1><p>“A” – b — c… <code>d’</code></p>")
    assert page.title == "Don't"
    assert page.sections[0].text == '"A" -- b --- c... `d’`'


def test_key_combinations_are_one_key(tmp_path: Path) -> None:
    key = '<kbd class="kbd">{}</kbd>'
    page = read_article(
        tmp_path, f'<p><kbd class="kbd compound">{key.format("Ctrl")}-{key.format("R")}</kbd></p>'
    )
    assert page.sections[0].text == "`Ctrl-R`"


def test_icons_leave_neither_marks_nor_empty_brackets(tmp_path: Path) -> None:
    page = read_article(
        tmp_path, '<p>Press (<span class="bl-icons-rec"></span>) or <span class="bl-icons-x"></span>.</p>'
    )
    assert page.sections[0].text == "Press or ."


def test_an_icon_before_a_heading_takes_its_dash_along(tmp_path: Path) -> None:
    page = read_article(tmp_path, '<h1>A - B</h1><h2><span class="bl-icons-x"></span> -- Solid</h2>')
    assert [section.title for section in page.sections] == ["A - B", "Solid"]


def test_file_names_are_not_captions(tmp_path: Path) -> None:
    page = read_article(
        tmp_path, '<p><img alt="_images/a.png" src="x"/></p><p><img alt="A cube" src="y"/></p>'
    )
    assert page.sections[0].text == "A cube"


def test_a_page_of_another_theme_is_read_from_its_main_element(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        "<div class='side'>menu</div><div role='main'><h1 id='t'>T</h1><p>Text.</p></div>"
    )
    (tmp_path / "b.html").write_text("<p>All there is</p>")
    first, second = read_html(tmp_path, source="manual", version="5.1")
    assert [(s.title, s.anchor, s.text) for s in first.sections] == [("T", "t", "Text.")]
    assert (second.title, second.sections[0].text) == ("B", "All there is")


def test_headings_without_sections_around_them_still_divide_the_page(tmp_path: Path) -> None:
    page = read_article(tmp_path, "<h1>A</h1>one<div><h2 id='b'>B</h2><p>two</p></div><h2>C</h2>three")
    assert [(s.level, s.title, s.anchor, s.text) for s in page.sections] == [
        (1, "A", "", "one"),
        (2, "B", "b", "two"),
        (2, "C", "", "three"),
    ]


def test_an_article_cut_off_half_way_keeps_what_is_there(tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text("<nav>menu</nav><article role='main'><h1>T</h1><p>Half a sen")
    page = read_html(tmp_path, source="manual", version="5.1")[0]
    assert (page.title, page.sections[0].text) == ("T", "Half a sen")


def test_a_page_in_another_encoding_is_kept_with_a_warning(tmp_path: Path) -> None:
    (tmp_path / "page.html").write_bytes("<article><h1>Café</h1></article>".encode("latin-1"))
    page = read_html(tmp_path, source="manual", version="5.1")[0]
    assert page.title == "Caf\ufffd"
    assert page.warnings == ("not UTF-8: undecodable characters were replaced",)


@pytest.mark.parametrize("content", ["", "<article></article>", "\x00", "<article", "]]><!doctype"])
def test_a_page_without_content_is_kept_under_a_title_from_its_slug(tmp_path: Path, content: str) -> None:
    (tmp_path / "edge_split.html").write_text(content)
    page = read_html(tmp_path, source="manual", version="5.1")[0]
    assert page.title == "Edge Split"
    assert len(page.sections) == 1


def test_spans_of_any_size_do_not_fill_the_memory(tmp_path: Path) -> None:
    cell = "<td colspan='999999' rowspan='999999'>x</td>"
    page = read_article(tmp_path, f"<table><tr>{cell}<td>y</td></tr><tr><td>z</td></tr></table>")
    assert page.sections[0].text == "|  |  |\n| --- | --- |\n| x | y |\n|  | z |"


def test_elements_nested_without_end_keep_their_text(tmp_path: Path) -> None:
    page = read_article(
        tmp_path, "<h1>T</h1>" + "<div><ul><li>" * 2_000 + "inmost" + "</li></ul></div>" * 2_000
    )
    assert "inmost" in page.text


def test_a_long_page_is_not_cut(tmp_path: Path) -> None:
    words = " ".join(f"word{number}" for number in range(5_000))
    assert read_article(tmp_path, f"<h1>T</h1><p>{words}</p>").sections[0].text == words


def test_a_folder_without_pages_is_named_in_the_error(tmp_path: Path) -> None:
    (tmp_path / "search.html").write_text("<article>")
    with pytest.raises(SourceError, match="holds no pages"):
        read_html(tmp_path, source="manual", version="5.1")
    with pytest.raises(SourceError, match=r"info_\*\.html"):
        read_html(tmp_path, source="guide", version="5.1")


def test_a_comparison_lists_the_differences(from_html: list[Page], from_rst: list[Page]) -> None:
    found = compare(from_rst, from_html)
    assert found.outline_share >= 14 / 16
    assert {row.slug for row in found.differences} <= FAULTY
    assert compare(from_rst[:1], from_rst[1:2]).shared == ()
