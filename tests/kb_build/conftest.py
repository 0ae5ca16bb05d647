"""A base that is built once, by real Blender, from the miniature documentation."""

from __future__ import annotations

import shutil
from importlib import metadata
from typing import TYPE_CHECKING

import pytest
from built_base import MINIATURE, Built
from made_once import made_once

from kb_build.pipeline import BuildOptions, build

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="session")
def blender_version() -> str:
    """The version of this environment's bpy; the test is skipped where there is none."""
    try:
        return metadata.version("bpy")
    except metadata.PackageNotFoundError:
        pytest.skip("this environment has no bpy")


@pytest.fixture(scope="session")
def built_once(tmp_path_factory: pytest.TempPathFactory, blender_version: str) -> Built:
    minor = ".".join(blender_version.split(".")[:2])

    def make(folder: Path) -> Built:
        corpora = folder / "corpora"
        shutil.copytree(MINIATURE / "manual", corpora / f"manual-{minor}-rst")
        shutil.copytree(MINIATURE / "guides", corpora / f"api-guides-{minor}-rst")
        options = BuildOptions(corpora=corpora, offline=True)
        return Built(folder / "home", corpora, build(None, options=options, home=folder / "home"))

    return made_once(tmp_path_factory, "built", make)


@pytest.fixture
def built(built_once: Built, tmp_path: Path) -> Built:
    """A base of one's own: from the miniature manual and guides, by this environment's Blender."""
    return built_once.copy(tmp_path)
