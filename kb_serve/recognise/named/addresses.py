"""Recognises URLs of the manual and the API reference, and slugs of pages."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_URL = re.compile(r"https?://[\w.]*blender\.org/(manual|api)/([^\s'\"<>)]*)")
_BEFORE_SLUG = {"manual": 2, "api": 1}  # language and version; version


def ids_in_urls(query: str, reader: BaseReader) -> Iterator[str]:
    """The ids of the symbols and pages whose URLs are in a query; of one URL, the closest first."""
    for site, rest in _URL.findall(query):
        page, _, anchor = rest.rstrip(".,;:!?").partition("#")
        parts = page.partition("?")[0].removesuffix(".html").strip("/").split("/")
        path = "/".join(parts[_BEFORE_SLUG[site] :])
        for symbol in (anchor, path):
            if symbol and reader.entry(symbol):
                yield symbol
        if slug := find_page(path, reader):
            yield slug


def find_page(text: str, reader: BaseReader) -> str:
    """The slug of the page that a text names, with a suffix or without ``/index`` too; "" for none."""
    if reader.manual.is_page(text):
        return text
    slug = text.strip("/").removesuffix(".html").removesuffix(".rst").strip("/")
    candidates = (slug, f"{slug}/index") if "/" in text else (slug,)
    return next((candidate for candidate in candidates if reader.manual.is_page(candidate)), "")
