"""Folders of documentation that hold links, pipes and files without end give their pages, and nothing else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import SourceError
from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from kb_build.pages.sources import DocumentationSource, find_sources

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kb_build.pages.page import Page

MIB = 1 << 20
SECRET = "swordfish"
PAGES = {"rst": "Page\n====\n\nText.\n", "html": "<article><h1>Page</h1><p>Text.</p></article>"}
READERS: dict[str, Callable[..., list[Page]]] = {"rst": read_rst, "html": read_html}


def spoiled(tmp_path: Path, form: str) -> Path:
    """A folder with two pages, and beside them what is none."""
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / f"secret.{form}").write_text(PAGES[form].replace("Text", SECRET))
    folder = tmp_path / "manual"
    (folder / "sub").mkdir(parents=True)
    (folder / f"index.{form}").write_text(PAGES[form])
    (folder / "sub" / f"page.{form}").write_text(PAGES[form])
    (folder / f"zero.{form}").symlink_to("/dev/zero")
    (folder / f"link.{form}").symlink_to(outside / f"secret.{form}")
    (folder / "linked").symlink_to(outside)
    (folder / "circle").symlink_to(folder)
    os.mkfifo(folder / f"pipe.{form}")
    with (folder / f"sparse.{form}").open("wb") as file:
        file.truncate(1 << 40)
    (folder / f"line.{form}").write_text("x" * 10 * MIB)
    return folder


def manual(folder: Path, cache: Path) -> DocumentationSource:
    (source,), _ = find_sources("5.1", cache=cache, manual=folder, allow_download=False)
    return source


@pytest.mark.parametrize("form", ["rst", "html"])
def test_only_regular_files_of_ordinary_size_are_read(tmp_path: Path, form: str) -> None:
    source = manual(spoiled(tmp_path, form), tmp_path / "cache")
    assert source.form == form
    assert (
        source.passed_over == "4 links, 1 entry that is neither file nor folder, 2 files that are too large"
    )
    pages = READERS[form](source.path, source="manual", version="5.1")
    assert [(page.slug, page.sections[0].text) for page in pages] == [
        ("index", "Text."),
        ("sub/page", "Text."),
    ]


@pytest.mark.parametrize("form", ["rst", "html"])
def test_the_digest_follows_no_link(tmp_path: Path, form: str) -> None:
    folder = spoiled(tmp_path, form)
    before = manual(folder, tmp_path / "cache").sha256
    (tmp_path / "outside" / f"secret.{form}").write_text("changed")
    (folder / f"another.{form}").symlink_to(tmp_path / "outside" / f"secret.{form}")
    assert manual(folder, tmp_path / "cache").sha256 == before


def test_a_folder_without_links_passes_nothing_over(tmp_path: Path) -> None:
    (tmp_path / "index.rst").write_text(PAGES["rst"])
    assert manual(tmp_path, tmp_path / "cache").passed_over == ""


def test_links_elsewhere_in_a_clone_are_not_counted(tmp_path: Path) -> None:
    clone = tmp_path / "clone"
    (clone / "manual").mkdir(parents=True)
    (clone / "manual" / "index.rst").write_text(PAGES["rst"])
    (clone / "lib").symlink_to("/usr/lib")
    source = manual(clone, tmp_path / "cache")
    assert (source.path, source.passed_over) == (clone / "manual", "")


def test_a_folder_of_links_alone_says_so(tmp_path: Path) -> None:
    (tmp_path / "outside.rst").write_text(PAGES["rst"])
    (tmp_path / "manual").mkdir()
    (tmp_path / "manual" / "index.rst").symlink_to(tmp_path / "outside.rst")
    with pytest.raises(SourceError, match=r"no manual pages.*passed over: 1 link"):
        manual(tmp_path / "manual", tmp_path / "cache")


@pytest.mark.parametrize("name", ["conf.py", "objects.inv", "index.html"])
def test_the_version_is_not_read_through_a_link_or_from_a_pipe(tmp_path: Path, name: str) -> None:
    told = "version = '4.2'\n# Version: 4.2\n<title>Blender 4.2</title>\n"
    folder = tmp_path / "pages"
    folder.mkdir()
    (folder / "index.rst").write_text(PAGES["rst"])
    (folder / name).write_text(told)
    assert manual(folder, tmp_path / "cache").version == "4.2"
    (folder / name).rename(tmp_path / "told")
    (folder / name).symlink_to(tmp_path / "told")
    assert manual(folder, tmp_path / "cache").version == "unknown"
    (folder / name).unlink()
    os.mkfifo(folder / name)
    assert manual(folder, tmp_path / "cache").version == "unknown"


def test_a_page_includes_nothing_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text(SECRET)
    folder = tmp_path / "manual"
    folder.mkdir()
    (folder / "index.rst").write_text(
        "Page\n====\n\n.. include:: link.txt\n\n.. literalinclude:: pipe.txt\n\n.. include:: real.txt\n"
    )
    (folder / "link.txt").symlink_to(tmp_path / "secret.txt")
    (folder / "real.txt").write_text("Really included.\n")
    os.mkfifo(folder / "pipe.txt")
    (page,) = read_rst(folder, source="manual", version="5.1")
    assert SECRET not in page.text
    assert page.sections[0].text.endswith("Really included.")
    assert len(page.warnings) == 2
