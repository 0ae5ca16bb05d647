"""Fingerprints follow all code that a base is made by."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build import fingerprint

if TYPE_CHECKING:
    import pytest


def test_code_in_every_folder_that_runs_inside_blender_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "kb_build"
    shutil.copytree(Path(fingerprint.__file__).parent / "blender", package / "blender")
    monkeypatch.setattr(fingerprint, "_PACKAGE", package)
    before = fingerprint.extractor_digest.__wrapped__()
    assert before == fingerprint.extractor_digest.__wrapped__()
    for file in sorted((package / "blender" / "inside").rglob("*.py")):
        whole = file.read_bytes()
        file.write_bytes(whole + b"# changed\n")
        assert fingerprint.extractor_digest.__wrapped__() != before, file
        file.write_bytes(whole)
