"""A page made to exhaust a reader is kept as text, with a warning, and the page beside it is read as ever."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from kb_build.pages.readers.workers import PageBudget

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.pages.page import Page

HEAD = "Hostile\n=======\n\n"
MIB = 1 << 20
# What ends otherwise must do so long before its time is over, on slow machines too.
PATIENT = PageBudget(cpu_seconds=60, memory=256 * MIB)
# For what would take far longer than this on any machine.
SHORT_RST = PageBudget(cpu_seconds=2, memory=256 * MIB)
SHORT_HTML = PageBudget(cpu_seconds=2, memory=256 * MIB)
TOO_LONG = "it took more than 2 s of computing"


def from_rst(folder: Path, text: str, budget: PageBudget = PATIENT) -> dict[str, Page]:
    (folder / "hostile.rst").write_text(text)
    (folder / "index.rst").write_text("Kind\n====\n\n.. toctree::\n\n   hostile\n\nSee :doc:`hostile`.\n")
    pages = read_rst(folder, source="manual", version="5.1", budget=budget)
    return {page.slug: page for page in pages}


def from_html(folder: Path, body: str, budget: PageBudget = PATIENT) -> dict[str, Page]:
    (folder / "hostile.html").write_text(f"<h1>Hostile</h1>{body}")
    (folder / "index.html").write_text("<h1>Kind</h1><p>See <a href='hostile.html'>Hostile</a>.</p>")
    pages = read_html(folder, source="manual", version="5.1", budget=budget)
    return {page.slug: page for page in pages}


def check_the_kind_page(pages: dict[str, Page]) -> None:
    kind = pages["index"]
    assert pages.keys() == {"index", "hostile"}
    assert (kind.title, kind.sections[0].text, kind.links) == ("Kind", "See Hostile.", ("hostile",))
    assert kind.warnings == ()


def chained_targets(length: int) -> str:
    links = "".join(f".. _t{n}: t{n + 1}_\n" for n in range(length))
    return f"{HEAD}`t0`_ leads on.\n\n{links}.. _t{length}: https://example.org\n"


def nested_grid_tables(depth: int) -> str:
    lines = ["x"]
    for _ in range(depth):
        width = len(lines[0])
        lines = [f"+{'-' * width}+", *(f"|{line}|" for line in lines), f"+{'-' * width}+"]
    return HEAD + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        pytest.param(
            HEAD + "|a|\n\n.. |b| replace:: c\n.. |a| replace:: " + "|b| " * 16_000 + "\n",
            TOO_LONG,
            id="substitutions of substitutions",
        ),
        pytest.param(
            HEAD + "|a|\n" * 200 + "\n.. |a| replace:: " + "word " * 10_000 + "\n",
            "what was read of it is too large",
            id="substitutions that multiply",
        ),
        pytest.param(chained_targets(2_000), "RecursionError", id="chained targets"),
        pytest.param(
            HEAD + "".join(f"{'  ' * n}- x{n}\n\n" for n in range(400)), "RecursionError", id="nested lists"
        ),
        pytest.param(nested_grid_tables(200), "RecursionError", id="nested tables"),
        pytest.param(HEAD + "x" * 7 * MIB, "a line of more than 100,000 characters", id="endless line"),
        pytest.param(HEAD + ":a" * 45_000 + "`", TOO_LONG, id="what may be a role"),
        pytest.param(
            HEAD + ".. cpp:function:: " + "a<" * 2_000 + "b" + ">" * 2_000 + " f()\n",
            "",
            id="nested templates",
        ),
    ],
)
def test_rst_beyond_the_budget_is_kept_as_plain_text(tmp_path: Path, text: str, reason: str) -> None:
    pages = from_rst(tmp_path, text, SHORT_RST if reason == TOO_LONG else PATIENT)
    check_the_kind_page(pages)
    hostile = pages["hostile"]
    assert hostile.title == "Hostile"
    assert hostile.warnings[0].startswith("kept as plain text: ")
    assert reason in hostile.warnings[0]
    assert hostile.sections[0].text.startswith(f"```\n{text[:1_000].rstrip()}")


def test_what_has_no_sign_of_markup_is_not_searched_for_any(tmp_path: Path) -> None:
    pages = from_rst(tmp_path, HEAD + ":a" * 45_000, SHORT_RST)
    check_the_kind_page(pages)
    assert pages["hostile"].warnings == ()
    assert pages["hostile"].sections[0].text == ":a" * 45_000


def test_references_of_the_version_cost_what_their_number_says(tmp_path: Path) -> None:
    pages = from_rst(tmp_path, HEAD + "|version|\n" * 16_000)
    assert pages["hostile"].warnings == ()
    assert pages["hostile"].sections[0].text == " ".join(["5.1"] * 16_000)


def test_a_chain_of_numbered_tables_of_contents_is_read(tmp_path: Path) -> None:
    for number in range(600):
        below = f".. toctree::\n   :numbered:\n\n   page_{number + 1:03}\n"
        (tmp_path / f"page_{number:03}.rst").write_text(f"Page {number}\n========\n\n{below}")
    pages = read_rst(tmp_path, source="manual", version="5.1")
    assert len(pages) == 600
    assert pages[599].breadcrumbs[-1] == "Page 598"
    assert max(len(page.breadcrumbs) for page in pages) == 20


SPANNING = "<table>" + ("<tr>" + "<td colspan=1000 rowspan=1000>x</td>" * 300 + "</tr>") * 30 + "</table>"
WIDE = "<table><tr>" + "<td>x</td>" * 5_000 + "</tr>" + "<tr><td>y</td></tr>" * 1_000 + "</table>"
DIAGONAL = (
    "<table>" + "".join(f"<tr><td colspan={n}></td><td>x</td></tr>" for n in range(1, 3_000)) + "</table>"
)


@pytest.mark.parametrize(
    ("table", "cells"),
    [
        pytest.param(SPANNING, 9_000, id="spans"),
        pytest.param(WIDE, 6_000, id="wide"),
        pytest.param(DIAGONAL, 2_999, id="diagonal"),
    ],
)
def test_a_table_becomes_no_larger_than_it_was(tmp_path: Path, table: str, cells: int) -> None:
    pages = from_html(tmp_path, table)
    check_the_kind_page(pages)
    hostile = pages["hostile"]
    assert hostile.warnings == ()
    assert len(hostile.text) < 2 * len(table)
    assert hostile.text.count("| x ") + hostile.text.count("| y ") == cells


def test_code_made_of_backticks_is_fenced(tmp_path: Path) -> None:
    pages = from_html(tmp_path, f"<pre>{'`' * 300_000}</pre>")
    check_the_kind_page(pages)
    assert pages["hostile"].sections[0].text == f"{'`' * 300_001}\n{'`' * 300_000}\n{'`' * 300_001}"


@pytest.mark.parametrize(
    ("body", "text"),
    [
        pytest.param("<dl><dt>x<dd>" * 2_000, " ".join(["Hostile", *["x"] * 2_000]), id="nested definitions"),
        pytest.param("<table><tr><td>x" * 2_000, " ".join(["Hostile", *["x"] * 2_000]), id="nested tables"),
        pytest.param(
            "<b>" * 2_000 + "inmost" + "<script>" * 100_000, "Hostile inmost", id="scripts without end"
        ),
        pytest.param("<b>" * 2_000 + "inmost" + "<" * 300_000, "Hostile inmost", id="elements without end"),
    ],
)
def test_html_nested_too_deep_is_kept_as_plain_text(tmp_path: Path, body: str, text: str) -> None:
    pages = from_html(tmp_path, body)
    check_the_kind_page(pages)
    assert pages["hostile"].warnings == ("kept as plain text: RecursionError while its markup was read",)
    assert pages["hostile"].sections[0].text == text


def test_html_that_takes_too_long_is_kept_as_plain_text(tmp_path: Path) -> None:
    pages = from_html(tmp_path, ("<div>" * 200 + "inmost" + "</div>" * 200) * 3_000, SHORT_HTML)
    check_the_kind_page(pages)
    hostile = pages["hostile"]
    assert hostile.warnings == ("kept as plain text: it took more than 2 s of computing",)
    assert hostile.sections[0].text == " ".join(["Hostile", *["inmost"] * 3_000])


def test_entities_are_not_expanded(tmp_path: Path) -> None:
    entities = "".join(f"<!ENTITY a{n} '{f'&a{n - 1};' * 10}'>" for n in range(1, 10))
    (tmp_path / "page.html").write_text(
        f"<!DOCTYPE html [<!ENTITY a0 'ten letters'>{entities}]><h1>Page</h1><p>&a9;&lt;</p>"
    )
    (page,) = read_html(tmp_path, source="manual", version="5.1", budget=PATIENT)
    assert len(page.text) < 2_000
    assert page.text.endswith("&a9;<")


def test_one_line_of_seven_megabytes_is_kept_with_a_warning(tmp_path: Path) -> None:
    pages = from_html(tmp_path, f"<p>{'word ' * (7 * MIB // 5)}</p>")
    check_the_kind_page(pages)
    assert pages["hostile"].warnings == ("kept as plain text: what was read of it is too large",)
    assert len(pages["hostile"].sections[0].text) == 400_003


def test_a_front_page_whose_sidebar_takes_too_long_costs_the_sidebar(tmp_path: Path) -> None:
    sidebar = '<div class="sidebar-tree">' + "<ul><li><a href='a.html'>A</a>" * 60_000 + "</aside>"
    (tmp_path / "index.html").write_text(f"{sidebar}<article><h1>Kind</h1><p>Text.</p></article>")
    (tmp_path / "a.html").write_text("<article><h1>A</h1></article>")
    pages = read_html(tmp_path, source="manual", version="5.1", budget=SHORT_HTML)
    assert [(page.title, page.warnings) for page in pages] == [("A", ()), ("Kind", ())]
