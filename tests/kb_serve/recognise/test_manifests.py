"""What is said of manifests of extensions is what Blender's own validator says."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from places import REPO

from kb_serve.recognise.messages import guides

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

pytestmark = pytest.mark.blender
_GOOD: dict[str, Any] = {
    "schema_version": "1.0.0",
    "id": "foo",
    "name": "Foo",
    "tagline": "Makes foo",
    "version": "1.0.0",
    "type": "add-on",
    "maintainer": "Who",
    "license": ["SPDX:GPL-3.0-or-later"],
    "blender_version_min": "4.2.0",
    "blender_version_max": "5.1.0",
    "permissions": {"network": "Loads maps from the net"},
}


def _errors(manifest: dict[str, Any]) -> list[str]:
    bpy: Any = pytest.importorskip("bpy")
    file = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    spec = importlib.util.spec_from_file_location("blender_ext", file)
    assert spec is not None
    assert spec.loader is not None
    validator: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(validator)
    return (
        validator.pkg_manifest_is_valid_or_error_impl(manifest, from_repo=False, all_errors=True, strict=True)
        or []
    )


def test_what_is_told_of_keys_is_valid() -> None:
    assert _errors(_GOOD) == []


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("permissions", ["network"], "`permissions` is a table"),
        ("tagline", "Makes foo.", "ends with no punctuation"),
        ("tagline", "f" * 65, "at most 64 characters"),
        ("type", "addon", '`type` is "add-on" or "theme".'),
        ("blender_version_min", "4.2", "is three numbers"),
        ("blender_version_max", "5.1", "three numbers"),
    ],
)
def test_what_the_validator_says_is_explained(kb: KnowledgeBase, key: str, value: object, said: str) -> None:
    (error,) = _errors(_GOOD | {key: value})
    assert said in "\n".join(kb.query(error).notes)


def test_the_guides_are_pages_of_the_manual() -> None:
    shipped = "".join(
        file.read_text(encoding="utf-8") for file in (REPO / "corpora" / "summaries").glob("5.1.*.jsonl")
    )
    for slug in (guides.ON_EXTENSIONS, guides.ON_TAGS, guides.ON_WHEELS):
        assert f'"{slug}"' in shipped
