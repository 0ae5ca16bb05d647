"""The real documentation: both forms of one manual agree, and the guides are read without loss."""

from __future__ import annotations

import tarfile
from typing import TYPE_CHECKING

import pytest

from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from measurements.reader_comparison import ReaderComparison, compare

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.pages.page import Page

pytestmark = pytest.mark.corpora
# Of the 2,000 HTML pages, so that the test takes a minute; `python -m measurements.page_forms` takes all.
EVERY = 6
LEAST = 2_000 // EVERY


def unpack(archive: Path, to: Path, *, every: int = 1) -> Path:
    """The archive's pages (or a share of them), and the front page; returns the folder of its index."""
    if not archive.is_file():
        pytest.skip(f"{archive.name} is not on this machine")
    count = 0
    with tarfile.open(archive, mode="r|xz") as files:
        for member in files:
            count += member.isfile()
            is_taken = count % every == 0 or member.name.rpartition("/")[2].startswith("index.")
            if member.isfile() and is_taken:
                files.extract(member, to, filter="data")
    return min(to.rglob("index.*"), key=lambda path: len(path.parts)).parent


@pytest.fixture(scope="module")
def comparison(corpora: Path, tmp_path_factory: pytest.TempPathFactory) -> ReaderComparison:
    folder = tmp_path_factory.mktemp("manual")
    sources = unpack(corpora / "manual-4.4-rst.tar.xz", folder / "rst")
    download = unpack(corpora / "manual-4.4-html.tar.xz", folder / "html", every=EVERY)
    pages = read_html(download, source="manual", version="4.4")
    return compare(read_rst(sources, source="manual", version="4.4"), pages)


@pytest.mark.whole
def test_titles_and_section_titles_agree_in_both_forms_of_the_manual(comparison: ReaderComparison) -> None:
    assert len(comparison.shared) > LEAST
    assert comparison.outline_share >= 0.98


@pytest.mark.whole
def test_texts_agree_in_both_forms_of_the_manual(comparison: ReaderComparison) -> None:
    assert comparison.similarity >= 0.99
    assert comparison.identical / len(comparison.shared) >= 0.93


@pytest.fixture(scope="module")
def guides(corpora: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Page]:
    archive = corpora / "api-guides-5.1-rst.tar.xz"
    if not archive.is_file():
        pytest.skip(f"{archive.name} is not on this machine")
    folder = tmp_path_factory.mktemp("guides")
    with tarfile.open(archive) as files:
        files.extractall(folder, filter="data")
    sources = next(folder.rglob("info_overview.rst")).parent
    return {page.slug: page for page in read_rst(sources, source="guide", version="5.1")}


def test_every_guide_is_a_page_with_sections_and_code(guides: dict[str, Page]) -> None:
    assert len(guides) == 15
    assert all(page.title and page.text for page in guides.values())
    assert guides["info_gotchas_meshes"].breadcrumbs == ("Gotchas",)
    assert "```python" in guides["info_quickstart"].text
    assert "`bpy.types.MeshPolygon`" in guides["info_gotchas_meshes"].text
