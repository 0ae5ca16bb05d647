"""The cache of pages that were read, in a folder that other builds work in, too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.pages.page_cache import kept_pages, read_pages
from kb_build.pages.sources import find_sources
from simworlds.terminal.progress import silent

if TYPE_CHECKING:
    from pathlib import Path


def test_an_old_cache_that_another_build_removes_meanwhile_costs_nothing(tmp_path: Path) -> None:
    (tmp_path / "manual").mkdir()
    (tmp_path / "manual" / "index.rst").write_text("Manual\n======\n\nSome words.\n")
    cache = tmp_path / "cache"
    (cache / "pages").mkdir(parents=True)
    (cache / "pages" / "gone.jsonl.gz").symlink_to("nowhere")  # as one that goes once it is listed
    (source,), _ = find_sources("5.1", cache=cache, manual=tmp_path / "manual", allow_download=False)
    pages = read_pages(source, cache, jobs=1, progress=silent)
    assert [page.title for page in pages] == ["Manual"]
    assert kept_pages(source, cache) == pages
