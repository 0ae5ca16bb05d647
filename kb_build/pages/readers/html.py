"""The official HTML download → pages, through BeautifulSoup."""

from __future__ import annotations

import html
import re
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from bs4 import BeautifulSoup, Tag

from kb_build.errors import SourceError
from kb_build.pages.readers import markdown as md
from kb_build.pages.readers.article import read_article
from kb_build.pages.readers.assemble import ROOT, PageText, assemble
from kb_build.pages.readers.html_elements import slug_of
from kb_build.pages.readers.workers import processes
from kb_build.records import Section

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kb_build.records import Page, PageSource

    Progress = Callable[[int, int], None]

_GENERATED = frozenset({"404", "genindex", "modindex", "py-modindex", "search"})
_CHUNK = 40
_ELEMENTS = ("article", "[role=main]", "main", "div.body", "body")
_SIDEBAR = b'<div class="sidebar-tree">'
_MARKUP = re.compile(rb"<(script|style)\b.*?</\1\s*>|<[^>]*>", re.DOTALL | re.IGNORECASE)


def read_html(
    folder: Path, *, source: PageSource, version: str, jobs: int = 2, progress: Progress | None = None
) -> list[Page]:
    """Every page of an HTML documentation below ``folder``, sorted by slug.

    Search page, index and the page for wrong addresses are left out; with ``source="guide"`` only the pages
    ``info_*.html`` are read (the API reference itself comes from Blender). ``version``, ``jobs`` and
    ``progress`` (pages done, pages in all) as in :func:`kb_build.pages.readers.rst.read_rst`, and the pages are the
    same as if they had been read from their RST sources. A page that cannot be understood is kept and carries
    warnings. Raises SourceError when there are no pages, or one cannot be read from disk.
    """
    folder = Path(folder)
    pattern = "info_*.html" if source == "guide" else "*.html"
    slugs = {
        path.relative_to(folder).with_suffix("").as_posix()
        for path in folder.rglob(pattern)
        if path.is_file()
    }
    names = sorted(slug for slug in slugs if slug not in _GENERATED and not _is_asset(slug))
    if not names:
        raise SourceError(
            f"{folder} holds no pages ({pattern}): give the folder with the documentation's index.html"
        )
    texts: list[PageText] = []

    def finished(part: list[PageText]) -> None:
        texts.extend(part)
        if progress is not None:
            progress(len(texts), len(names))

    _read_all(partial(_read_some, folder), names, processes(jobs, len(names)), finished)
    listed = _listed(folder / f"{ROOT}.html")
    texts = [replace(text, children=_merged(text.children, listed.get(text.slug, {}))) for text in texts]
    return assemble(texts, source=source, version=version)


def _listed(front: Path) -> dict[str, dict[str, None]]:
    """Who lists whom, from the front page's sidebar. It is the same on every page and slow to parse, but
    knows the tables of contents that the pages themselves do not show."""
    data = front.read_bytes() if front.is_file() else b""
    start = data.find(_SIDEBAR)
    if start < 0:
        return {}
    end = data.find(b"</aside>", start)
    tree = BeautifulSoup(data[start:end].decode("utf-8", errors="replace"), "lxml")
    children: dict[str, dict[str, None]] = {}
    for item in tree.select("li:has(> a)"):
        above = item.find_parent("li")
        parent = _target(above) if above is not None else ROOT
        if parent and (child := _target(item)):
            children.setdefault(parent, {}).setdefault(child)
    return children


def _target(item: Tag) -> str:
    anchor = item.find("a", recursive=False)
    href = str(anchor.get("href", "")) if isinstance(anchor, Tag) else ""
    return ROOT if href == "#" else slug_of(href, "")


def _merged(shown: tuple[str, ...], listed: dict[str, None]) -> tuple[str, ...]:
    return tuple(listed) if listed.keys() >= set(shown) else tuple(dict.fromkeys([*shown, *listed]))


def _is_asset(slug: str) -> bool:
    """Sphinx keeps pictures, scripts and copies of sources in folders that begin with an underscore."""
    return any(part.startswith("_") for part in slug.split("/")[:-1]) or slug.startswith("genindex-")


def _read_all(
    read: Callable[[Sequence[str]], list[PageText]],
    names: list[str],
    jobs: int,
    finished: Callable[[list[PageText]], None],
) -> None:
    chunks = [names[at : at + _CHUNK] for at in range(0, len(names), _CHUNK)]
    if jobs == 1:
        for chunk in chunks:
            finished(read(chunk))
        return
    try:
        with ProcessPoolExecutor(jobs, mp_context=get_context("fork")) as pool:
            futures: list[Future[list[PageText]]] = [pool.submit(read, chunk) for chunk in chunks]
            for future in as_completed(futures):
                finished(future.result())
    except BrokenProcessPool as error:
        raise SourceError("a process that read HTML pages was killed: try again with jobs=1") from error


def _read_some(folder: Path, slugs: Sequence[str]) -> list[PageText]:
    return [_read_one(folder / f"{slug}.html", slug) for slug in slugs]


def _read_one(path: Path, slug: str) -> PageText:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SourceError(
            f"{path} cannot be read ({error.strerror}): unpack the documentation again"
        ) from error
    cut = _article(data)
    warnings: list[str] = []
    try:
        text = cut.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = cut.decode("utf-8", errors="replace")
        warnings.append("not UTF-8: undecodable characters were replaced")
    try:
        root = _main_element(BeautifulSoup(text, "lxml"))
        article = read_article(root, slug)
    except (RecursionError, ValueError, TypeError, AttributeError) as error:  # markup out of all shape
        reason = f"kept as plain text: {type(error).__name__} while its markup was read"
        return PageText(slug=slug, sections=(_plain(cut),), warnings=(*warnings, reason))
    if root.name == "body" and not any(section.text for section in article.sections):
        warnings.append("the page holds no text")
    return PageText(
        slug=slug,
        sections=tuple(article.sections),
        children=tuple(article.children),
        links=tuple(article.links),
        warnings=tuple(warnings),
    )


def _article(data: bytes) -> bytes:
    """The bytes of the article alone: nine tenths of a page are its sidebar, and parsing takes the time."""
    start = data.find(b"<article")
    if start < 0:
        return data
    end = data.rfind(b"</article>")
    return data[start : end + len(b"</article>")] if end > start else data[start:]


def _main_element(soup: BeautifulSoup) -> Tag:
    for selector in _ELEMENTS:
        found = soup.select_one(selector)
        if found is not None:
            return found
    return soup


def _plain(data: bytes) -> Section:
    text = html.unescape(_MARKUP.sub(b" ", data).decode("utf-8", errors="replace"))
    return Section(anchor="", title="", level=1, text=md.fold(text))
