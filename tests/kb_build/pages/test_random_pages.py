"""No page, of whatever constructs it is put together, takes the pages beside it with it."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from whole import examples

from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from kb_build.pages.readers.workers import PageBudget

BUDGET = PageBudget(cpu_seconds=2, memory=512 << 20)
NAMES = st.sampled_from(["a", "b", "page", "index", "tärget", "x y", ""])
MARKS = "` |a| * ``x [1]_ a_ :ref:`page` :doc:`index` \\ &lt; <!-- ]]> |version| :kbd:`a` `a_<b>`__"
TEXTS = st.one_of(st.text(max_size=30), st.sampled_from(MARKS.split()))
DIRECTIVES = (
    "note figure toctree include literalinclude csv-table list-table code-block math only replace image glossary "
    "index rubric hlist highlight contents default-role role raw class container table parsed-literal tabs "
    "productionlist cpp:function py:class option reference todo sectnum target-notes meta date unicode header"
)
OPTIONS = (
    ":numbered:;:glob:;:hidden:;:widths: 1 2;:header-rows: 9;:start-after: x;:name: a;:lines: 1-;:language: python;"
    ":columns: 0;:depth: -1;:file: /etc/hostname;:class: a b;:emphasize-lines: 99"
)


@st.composite
def directives(draw: st.DrawFn, inner: st.SearchStrategy[str]) -> str:
    argument = draw(st.one_of(NAMES, TEXTS)).replace("\n", " ").replace("\r", " ")
    options = draw(st.lists(st.sampled_from(OPTIONS.split(";")), max_size=3))
    body = draw(inner)
    lines = [*options, "", *body.splitlines()]
    return f".. {draw(st.sampled_from(DIRECTIVES.split()))}:: {argument}\n" + "\n".join(
        f"   {line}" for line in lines
    )


@st.composite
def indented(draw: st.DrawFn, inner: st.SearchStrategy[str]) -> str:
    mark = draw(
        st.sampled_from(
            ["- ", "1. ", "#. ", "   ", "| ", ">>> ", ":field: ", "-o  ", ".. [1] ", ".. |a| replace:: "]
        )
    )
    first, *rest = draw(inner).splitlines() or [""]
    return "\n".join([mark + first, *(" " * len(mark) + line for line in rest)])


@st.composite
def headed(draw: st.DrawFn, inner: st.SearchStrategy[str]) -> str:
    title = draw(TEXTS).replace("\n", " ")
    return f"{title}\n{draw(st.sampled_from('=-~^')) * draw(st.integers(1, 40))}\n\n{draw(inner)}"


def chain(length: int) -> str:
    """Targets that lead to one another, down to one that exists."""
    return (
        "".join(f".. _t{n}: t{n + 1}_\n" for n in range(length)) + f"\n.. _t{length}: https://example.org\n"
    )


def stairs(depth: int, mark: str) -> str:
    """Blocks within blocks."""
    return "".join(f"{' ' * len(mark) * n}{mark}x\n\n" for n in range(depth))


DISASTERS = st.sampled_from(["", chain(1_500), stairs(300, "- ")])
RST = st.recursive(
    st.one_of(
        TEXTS,
        st.builds(chain, st.integers(0, 30)),
        st.builds(stairs, st.integers(0, 30), st.sampled_from(["- ", "1. ", ".. note:: ", "   "])),
        st.builds(".. _{0}: {1}_".format, NAMES, NAMES),
        st.builds(".. |{0}| replace:: |{1}| {2}".format, NAMES, NAMES, TEXTS),
        st.sampled_from(
            [
                "+--+--+\n|a | b|\n+--+--+\n|  c  |\n+-----+",
                "== ==\na  b\n== ==\nc  d\n== ==",
                "term\n   body",
            ]
        ),
    ),
    lambda inner: st.one_of(
        directives(inner), indented(inner), headed(inner), st.lists(inner, max_size=4).map("\n\n".join)
    ),
    max_leaves=25,
)

TAGS = (
    "p div table tr td th caption ul ol li dl dt dd pre code span a b h1 h2 h6 section article figure figcaption img "
    "br script style blockquote kbd aside main body html template svg math noscript form select title x-y"
)
ATTRIBUTES = (
    ";class='admonition note';class='highlight-python';class='math';class='toctree-wrapper';id=a;role=main;alt=x;"
    "colspan=999999 rowspan=3;rowspan=1000;class='line-block';class=footnote;start=-1;href='page.html#x';"
    "href='../../x.html';href='http://x';class='hlist';class=sig"
)


@st.composite
def elements(draw: st.DrawFn, inner: st.SearchStrategy[str]) -> str:
    tag = draw(st.sampled_from(TAGS.split()))
    attributes = draw(st.sampled_from(ATTRIBUTES.split(";")))
    close = draw(st.sampled_from([f"</{tag}>", f"</{tag}>", "", "</p>"]))
    return f"<{tag} {attributes}>" + f"{''.join(draw(st.lists(inner, max_size=4)))}{close}"


SPANS = "<table><tr>" + "<td colspan=1000 rowspan=1000>x</td>" * 2_000
HTML = st.recursive(TEXTS, elements, max_leaves=40)
pytestmark = pytest.mark.slow
BOUNDED = settings(
    max_examples=examples(10),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@BOUNDED
@given(text=st.builds("{}\n\n{}".format, RST, DISASTERS))
def test_any_rst_leaves_the_page_beside_it_as_it_is(text: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "page.rst").write_text(text, encoding="utf-8", errors="replace")
        (folder / "index.rst").write_text("Kind\n====\n\n.. _kind:\n\nText of :doc:`itself <index>`.\n")
        pages = {page.slug: page for page in read_rst(folder, source="manual", version="5.1", budget=BUDGET)}
    assert pages.keys() == {"index", "page"}
    assert pages["index"].sections[0].text == "Text of itself."
    assert pages["page"].title


@BOUNDED
@given(text=st.builds("{}{}".format, HTML, st.sampled_from(["", "<b>" * 2_000, SPANS])))
def test_any_html_leaves_the_page_beside_it_as_it_is(text: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "page.html").write_text(text, encoding="utf-8", errors="replace")
        (folder / "index.html").write_text("<article><h1>Kind</h1><p>Text.</p></article>")
        pages = {page.slug: page for page in read_html(folder, source="manual", version="5.1", budget=BUDGET)}
    assert pages.keys() == {"index", "page"}
    assert pages["index"].sections[0].text == "Text."
    assert pages["page"].title
