"""Fixtures that every test may ask for."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def corpora() -> Path:
    """The folder with the real documentation sources; the test is skipped where it is absent."""
    folder = Path(os.environ.get("SIMWORLDS_CORPORA") or REPO.parent / "shared" / "corpora")
    if not folder.is_dir():
        pytest.skip("the real documentation sources are not on this machine")
    return folder


@pytest.fixture(scope="session")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a real base of this environment's Blender, with the miniature documentation's pages.

    Its home folder is ``base.parent.parent``. Never write to it.
    """
    from kb_build.pipeline import BuildOptions, build
    from kb_build.runtime import installed_bpy

    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    mini = REPO / "tests" / "corpora_mini"
    options = BuildOptions(manual=mini / "manual", guides=mini / "guides", offline=True)
    return build(None, options=options, home=tmp_path_factory.mktemp("home")).path
