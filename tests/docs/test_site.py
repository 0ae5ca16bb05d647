"""The documentation site: built with its links checked, it loads nothing from elsewhere and has all that it should."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from places import REPO

from agents.protocol.rules.catalogue import RULES
from docs.generate.site_hooks import on_page_markdown

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow

# What a browser loads by itself, unlike the target of a link.
LOADED = re.compile(
    r"""<(?:script|img|iframe|source)[^>]+src=["']?(https?:)?//|<link[^>]+href=["']?(https?:)?//"""
)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=REPO, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_pages_load_nothing_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 80
    for page in pages:
        assert not LOADED.search(page.read_text(encoding="utf-8")), page
    for style in site.rglob("*.css"):
        assert not re.search(r"(@import|url\()\s*[\"']?(https?:)?//", style.read_text(encoding="utf-8")), (
            style
        )


def test_every_rule_has_its_page_and_picture_in_the_navigation(site: Path) -> None:
    index = (site / "rules.html").read_text(encoding="utf-8")
    for rule in RULES:
        assert f'href="rules/{rule.id}.html"' in index
        assert (site / "rules" / f"{rule.id}.png").is_file()


def test_no_program_and_no_cache_is_in_the_site(site: Path) -> None:
    assert not [
        path for path in site.rglob("*") if path.suffix in {".py", ".pyc"} or path.name == "__pycache__"
    ]


class _Page:
    class file:  # noqa: N801 - as MkDocs names it
        src_uri = "rules/V1.md"


def test_links_into_the_repository_become_words_and_others_stay() -> None:
    text = "[all](../rules.md), [tool](../tools.md#x), [policy](../../SECURITY.md), [V2](V2.md)"
    told = on_page_markdown(text, _Page())  # pyright: ignore[reportArgumentType]
    assert told == "[all](../rules.md), [tool](../tools.md#x), policy, [V2](V2.md)"
