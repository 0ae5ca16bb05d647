"""The official HTML download → pages, through BeautifulSoup."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bs4 import BeautifulSoup, Tag

from kb_build.errors import SourceError
from kb_build.pages.page import Section
from kb_build.pages.readers import markdown as md
from kb_build.pages.readers.article import read_article
from kb_build.pages.readers.assemble import ROOT, PageText, assemble
from kb_build.pages.readers.html_elements import slug_of
from kb_build.pages.readers.workers import PageBudget, PageWork, read_apart, read_elsewhere
from simworlds.folder_files import FolderLimits, list_files, read_file
from simworlds.forked import can_fork

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_build.pages.page import Page, PageSource

    Progress = Callable[[int, int], None]

_GENERATED = frozenset({"404", "genindex", "modindex", "py-modindex", "search"})
_ELEMENTS = ("article", "[role=main]", "main", "div.body", "body")
_SIDEBAR = b'<div class="sidebar-tree">'
# What is not closed ends with the page: looking for an end that is not there would cost each start the whole page.
_MARKUP = re.compile(
    rb"<script\b(?:(?!</script).)*+(?:</script[^>]*+>?|\Z)|<style\b(?:(?!</style).)*+(?:</style[^>]*+>?|\Z)|<[^>]*+>?",
    re.DOTALL | re.IGNORECASE,
)
_LIMITS = FolderLimits(file_bytes=8 << 20)


def read_html(  # noqa: PLR0913 - what, and how much of it
    folder: Path,
    *,
    source: PageSource,
    version: str,
    jobs: int = 2,
    progress: Progress | None = None,
    budget: PageBudget | None = None,
) -> list[Page]:
    """Every page of an HTML documentation below ``folder``, sorted by slug.

    Search page, index and the page for wrong addresses are left out; with ``source="guide"`` only the pages
    ``info_*.html`` are read (the API reference itself comes from Blender). ``version``, ``jobs``, ``budget`` and
    ``progress`` (pages done, pages in all) as in :func:`kb_build.pages.readers.rst.read_rst`, and the pages are the
    same as if they had been read from their RST sources. A page that cannot be understood is kept and carries
    warnings. Raises SourceError when there are no pages, or one cannot be read from disk.
    """
    folder, budget = Path(folder), budget or PageBudget()
    if not can_fork():
        return read_elsewhere(
            read_html,
            folder=folder,
            source=source,
            version=version,
            jobs=jobs,
            progress=progress,
            budget=budget,
        )
    start = "info_" if source == "guide" else ""
    try:
        files = list_files(
            folder, lambda path: path.suffix == ".html" and path.name.startswith(start), _LIMITS
        ).files
    except OSError as error:
        raise SourceError(f"{folder} cannot be read ({error})") from error
    slugs = [file.name.removesuffix(".html") for file in files]
    names = sorted(slug for slug in slugs if slug not in _GENERATED and not _is_asset(slug))
    if not names:
        raise SourceError(
            f"{folder} holds no pages ({start}*.html): give the folder with the documentation's index.html"
        )
    done = 0

    def finished(_: str) -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, len(names))

    work = PageWork(partial(_read_one, folder), done=finished)
    found = read_apart(names, work, jobs=jobs, budget=budget)
    texts: list[PageText] = [*found.answers.values()]
    texts += [_plain_page(_bytes(folder, slug), slug, reason) for slug, reason in found.failed.items()]
    listed = read_apart(
        [ROOT] if ROOT in slugs else [], PageWork(partial(_listed, folder)), jobs=1, budget=budget
    ).answers.get(ROOT, {})
    texts = [replace(text, children=_merged(text.children, listed.get(text.slug, {}))) for text in texts]
    return assemble(texts, source=source, version=version)


def _bytes(folder: Path, slug: str) -> bytes:
    try:
        return read_file(folder, f"{slug}.html", most=_LIMITS.file_bytes)
    except OSError as error:
        raise SourceError(
            f"{folder / slug}.html cannot be read ({error.strerror or error}): unpack the documentation again"
        ) from error


def _listed(folder: Path, slug: str) -> dict[str, dict[str, None]]:
    """Who lists whom, from the front page's sidebar. It is the same on every page and slow to parse, but
    knows the tables of contents that the pages themselves do not show."""
    data = _bytes(folder, slug)
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


def _read_one(folder: Path, slug: str) -> PageText:
    data = _bytes(folder, slug)
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
        return _plain_page(data, slug, f"{type(error).__name__} while its markup was read")
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


def _plain_page(data: bytes, slug: str, reason: str) -> PageText:
    """A page as it reads without its markup. This cannot fail, and takes time that grows with the page alone."""
    text = html.unescape(_MARKUP.sub(b" ", _article(data)).decode("utf-8", errors="replace"))
    section = Section(anchor="", title="", level=1, text=md.cut(md.fold(text)))
    return PageText(slug=slug, sections=(section,), warnings=(f"kept as plain text: {reason}",))
