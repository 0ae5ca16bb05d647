"""What stands beside the choices that the manual lists: identifiers, and that a setting has no such choice."""

from __future__ import annotations

import tarfile
from typing import TYPE_CHECKING

import pytest

from kb_build.index.passages import Passage, find_passages
from kb_build.index.value_names import find_value_names
from kb_build.pages.page import Page, Section
from kb_build.pages.readers.rst import read_rst
from kb_build.symbols.records import EnumItem, Symbol
from kb_build.symbols.taken import Setting, Taken

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

SLUG = "physics/cache"
CLASS = "bpy.types.Domain"
ITEMS = (EnumItem("REPLAY", "Replay"), EnumItem("MODULAR", "Modular"), EnumItem("ALL", "All"))
HAS = "in this Blender, which has `'REPLAY'`, `'MODULAR'`, `'ALL'`)"
CHAPTER = "physics/fluid/"


def enumeration(name: str = "cache_type", label: str = "Type", items: tuple[EnumItem, ...] = ITEMS) -> Symbol:
    return Symbol(f"{CLASS}.{name}", "property", CLASS, label=label, type="enum", enum_items=items)


def beside(text: str, *symbols: Symbol, line: int = 0, title: str = "Cache") -> dict[str, str]:
    """The first words of a line → what stands beside it; all symbols have their passage at ``line``."""
    page = Page(SLUG, "manual", "5.1", title, (Section("cache", "Cache", 1, text),))
    symbols = symbols or (enumeration(),)
    passages = {symbol.path: Passage(SLUG, 0, line) for symbol in symbols if symbol.type == "enum"}
    rows = find_value_names(symbols, [page], passages)
    lines = text.split("\n")
    return {lines[row.line].strip("- *").split(":")[0].split("*")[0]: row.names for row in rows}


LISTED = "**Type**\n  How it is kept.\n\n  - **Replay:** As played.\n  - **Modular:** In steps.\n"


def test_choices_have_their_identifiers() -> None:
    assert beside(LISTED) == {"Replay": "`'REPLAY'`", "Modular": "`'MODULAR'`"}


def test_a_choice_of_one_of_several_settings_says_whose_it_is() -> None:
    other = enumeration("preview_cache_type", items=ITEMS[:2])
    listed = LISTED + "  - **All:** At once.\n"
    assert beside(listed, enumeration(), other) == {
        "Replay": "`'REPLAY'`",
        "Modular": "`'MODULAR'`",
        "All": "`'ALL'` (`cache_type` only)",
    }


@pytest.mark.parametrize(
    ("term", "items", "expected"),
    [
        ("8", (EnumItem("8", "8"),), ""),  # nothing to add
        ("Albedo + Normal", (EnumItem("RGB_ALBEDO_NORMAL", "Albedo and Normal"),), "`'RGB_ALBEDO_NORMAL'`"),
        ("Faces", (EnumItem("FACE", "Face"),), "`'FACE'`"),
        ("[Multiply](https://docs.example.org/mul)", (EnumItem("MUL", "Multiply"),), "`'MUL'`"),
        ("Red, Green", (EnumItem("R", "Red"), EnumItem("G", "Green")), "`'R'`, `'G'`"),
        ("Red, Blue", (EnumItem("R", "Red"), EnumItem("G", "Green")), ""),
        ("Euler", (EnumItem("XYZ", "Euler"), EnumItem("ZYX", "Euler")), ""),  # one of two
    ],
)
def test_a_choice_means_what_it_surely_names(term: str, items: tuple[EnumItem, ...], expected: str) -> None:
    symbol = enumeration(items=(*items, EnumItem("KNOWN", "Known")))
    found = beside(f"**Type**\n  - **{term}:** It is.\n  - **Known:** It is.", symbol)
    found.pop("Known")
    assert "".join(found.values()) == expected


def test_words_that_say_nothing_are_not_taken_for_each_other() -> None:
    assert beside(f"{LISTED}  - **Else:** Another.")["Else"].startswith("(“Else”")


def test_a_choice_that_blender_has_not_is_said_to_be_none() -> None:
    assert (
        beside(f"{LISTED}  - **Final:** At once.\n")["Final"]
        == f"(“Final” is not a value of `Domain.cache_type` {HAS}"
    )


@pytest.mark.parametrize(
    "more",
    [
        "  - **All at once:** Nearly an item.",
        "  - **Resumable:** A setting.",
        "  **Final**\n    A definition, which may be a setting.",
        "  - **Modular:** In steps.\n\n    - **Final:** Of the modular one.",
        "  Else:\n\n  - **Final:** In another list.\n  - **First:** There, too.",
        "\n**Final**\n  A label of its own.",
    ],
)
def test_what_need_not_be_a_choice_is_passed_over(more: str) -> None:
    setting = Symbol(f"{CLASS}.resumable", "property", CLASS, label="Resumable", type="boolean")
    assert "Final" not in "".join(beside(LISTED + more, enumeration(), setting).values())
    assert "not a value" not in "".join(beside(LISTED + more, enumeration(), setting).values())


@pytest.mark.parametrize(
    "symbol",
    [
        Symbol(f"{CLASS}.t", "property", CLASS, type="enum", enum_items=ITEMS, enum_computed=True),
        enumeration(items=(*ITEMS[:2], EnumItem("ALL", "All", where=Taken("only", (Setting("x", ("Y",)),))))),
    ],
)
def test_of_items_that_depend_on_the_context_none_is_denied(symbol: Symbol) -> None:
    assert set(beside(f"{LISTED}  - **Final:** At once.\n", symbol)) == {"Replay", "Modular"}


def test_below_a_heading_several_choices_make_a_list() -> None:
    one = "- **Replay:** As played.\n- **Quality:** Else.\n- **Size:** Else."
    assert beside(one, line=-1) == {}
    assert set(beside(f"{one}\n- **All:** At once.", line=-1)) == {"Replay", "All", "Quality", "Size"}


@pytest.mark.parametrize(
    ("said", "is_denied"),
    [
        ("Only available when using the Final cache type.", True),
        ("Only available when using the *Final* cache type.", True),
        ("Only available when using the Modular cache type.", False),
        ("This is the cache type. The Final one was another.", False),
        ("The Cache cache type.", False),  # the page is called so
    ],
)
def test_text_that_names_a_choice_that_is_none(said: str, *, is_denied: bool) -> None:
    assert any("not a value" in names for names in beside(f"{LISTED}\n{said}").values()) is is_denied


@pytest.fixture(scope="module")
def chapter(corpora: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Page]:
    """The pages on fluids of the real manual."""
    archive, folder = corpora / "manual-5.1-rst.tar.xz", tmp_path_factory.mktemp("manual")
    if not archive.is_file():
        pytest.skip(f"{archive.name} is not on this machine")
    with tarfile.open(archive, mode="r|xz") as files:
        for member in files:
            if CHAPTER in member.name or member.name.rpartition("/")[2].startswith("index."):
                files.extract(member, folder, filter="data")
    root = min(folder.rglob("index.*"), key=lambda path: len(path.parts)).parent
    return [page for page in read_rst(root, source="manual", version="5.1") if page.slug.startswith(CHAPTER)]


@pytest.mark.corpora
@pytest.mark.blender
def test_the_real_manual_beside_the_real_blender(chapter: list[Page], extract: Extract) -> None:
    passages = find_passages(extract.symbols, chapter, extract.links)
    rows = find_value_names(extract.symbols, chapter, passages)
    texts = {page.slug: [section.text.split("\n") for section in page.sections] for page in chapter}
    by_line = {texts[row.slug][row.section][row.line]: row.names for row in rows}
    assert len(rows) > 30
    named = {line.partition(":**")[0].strip(" -*"): names for line, names in by_line.items()}
    assert (named["Replay"], named["Modular"], named["All"]) == ("`'REPLAY'`", "`'MODULAR'`", "`'ALL'`")
    denied = [names.partition("”")[0] for names in by_line.values() if names.startswith("(")]
    assert set(denied) - {"(“Blosc"} == {"(“Final"}  # Blender may be built without Blosc
