"""Dependencies' licences: known, compatible with the GPL, and listed."""

from __future__ import annotations

from importlib import metadata

import pytest
from places import REPO

from release.licences import Dependency, dependencies, is_compatible, licence_of, page, pinned


@pytest.fixture(scope="module")
def rows() -> list[Dependency]:
    return dependencies(REPO)


def test_every_dependency_has_a_licence_that_the_gpl_may_be_combined_with(rows: list[Dependency]) -> None:
    assert [(row.name, row.licence) for row in rows if not row.compatible] == []


def test_every_dependency_is_pinned(rows: list[Dependency]) -> None:
    assert [row.name for row in rows if not row.version] == []


def test_the_page_is_up_to_date(rows: list[Dependency]) -> None:
    written = (REPO / "docs" / "licences.md").read_text(encoding="utf-8")
    assert written == page(rows), "run: make licences"


def test_what_is_needed_of_what_is_needed_is_among_them(rows: list[Dependency]) -> None:
    by_name = {row.name: row for row in rows}
    assert by_name["mcp"].direct
    assert not by_name["starlette"].direct
    assert by_name["bpy"].extras == {"blender"}
    assert by_name["colorama"].licence == "BSD-3-Clause", "on Windows"
    assert by_name["docutils"].licence == "LicenseRef-Public-Domain AND BSD-2-Clause", "by its licence file"
    assert "pytest" not in by_name


@pytest.mark.parametrize(
    ("expression", "fits"),
    [
        ("MIT", True),
        ("MIT AND Apache-2.0", True),
        ("MIT AND (SSPL-1.0 OR BSD-3-Clause)", True),
        ("GPL-2.0-only", False),
        ("MIT AND CC-BY-NC-4.0", False),
        ("BUSL-1.1 OR Proprietary", False),
        ("", False),
        ("MIT AND", False),
        ("(MIT", False),
        ("MIT MIT", False),
    ],
)
def test_alternatives_and_parts_are_told_apart(expression: str, fits: bool) -> None:
    assert is_compatible(expression) is fits


@pytest.mark.parametrize(
    ("fields", "licence"),
    [
        ({"License-Expression": ["GPL-2.0-only"]}, ""),
        ({"License": ["All rights reserved"]}, ""),
        ({}, ""),
        (
            {
                "Classifier": [
                    "License :: OSI Approved :: MIT License",
                    "License :: Other/Proprietary License",
                ]
            },
            "",
        ),
        ({"Classifier": ["License :: OSI Approved :: MIT License"]}, "MIT"),
        ({"Classifier": ["License :: OSI Approved :: BSD License"]}, ""),
        ({"Classifier": ["License :: OSI Approved :: GNU General Public License (GPL)"]}, ""),
        ({"License": ["MIT, BSD"]}, ""),
    ],
)
def test_what_is_not_known_is_no_licence(
    monkeypatch: pytest.MonkeyPatch, fields: dict[str, list[str]], licence: str
) -> None:
    class Facts:
        def get_all(self, name: str, default: list[str]) -> list[str]:
            return fields.get(name, default)

    monkeypatch.setattr(metadata, "metadata", lambda _: Facts())
    assert licence_of("some-package") == licence


def test_of_several_pins_the_newest_counts() -> None:
    assert pinned("sphinx==9.0.4 ; a\nsphinx==9.10.0 ; b\nsphinx==9.2.0 ; c\n") == {"sphinx": "9.10.0"}
