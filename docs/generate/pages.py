"""All generated pages, and the check that the written ones are up to date."""

from __future__ import annotations

from typing import TYPE_CHECKING

from docs.generate.benchmark_pages import predicates_page, relations_page
from docs.generate.check_pages import FOLDER as CHECK_FOLDER
from docs.generate.check_pages import check_pages
from docs.generate.command_page import command_page
from docs.generate.rule_pages import FOLDER as RULE_FOLDER
from docs.generate.rule_pages import rule_pages
from docs.generate.tool_pages import blender_tools_page, docs_tool_page

if TYPE_CHECKING:
    from pathlib import Path


def pages() -> dict[str, str]:
    """File name below docs → text."""
    return {
        "blender-tools.md": blender_tools_page(),
        "cli.md": command_page(),
        "predicates.md": predicates_page(),
        "relations.md": relations_page(),
        "tools.md": docs_tool_page(),
        **rule_pages(),
        **check_pages(),
    }


def outdated(folder: Path) -> list[str]:
    """Names of the pages in ``folder`` that are missing, differ from what they should be, or are left over."""
    wanted = pages()
    changed = [name for name, text in wanted.items() if _text_of(folder / name) != text]
    return changed + _left_over(folder, wanted)


def write(folder: Path) -> None:
    """Writes all pages into ``folder``, and removes those of rules that no longer exist."""
    wanted = pages()
    for name, text in wanted.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    for name in _left_over(folder, wanted):
        (folder / name).unlink()


def _left_over(folder: Path, wanted: dict[str, str]) -> list[str]:
    names = sorted(
        path.relative_to(folder).as_posix()
        for below in (RULE_FOLDER, CHECK_FOLDER)
        for path in folder.glob(f"{below}/*.md")
    )
    return [name for name in names if name not in wanted]


def _text_of(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.is_file() else None
