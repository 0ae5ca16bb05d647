"""A run's folder: names in it, and who works in it."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import pytest
from live_session import no_docs

from agents.blender.blender_sessions import BlenderSession, SessionSetup
from agents.blender.files.run_folder import RunFolder, new_root, new_run
from agents.blender.tools import scene_state
from agents.blender.tools.base import Call, Knowledge
from simworlds.folder_lock import locked
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import CannotStart, Refusal

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def folder(tmp_path: Path) -> RunFolder:
    return RunFolder.make(tmp_path / "run")


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A file that executed code must neither read nor write through the host."""
    path = tmp_path / "outside" / "secret.blend"
    path.parent.mkdir()
    path.write_text("secret")
    return path


# Names that callers give


@pytest.mark.parametrize(
    ("name", "lies"),
    [
        ("tower", "tower.blend"),
        ("tower.blend", "tower.blend"),
        ("saves/tower", "saves/tower.blend"),
        ("saves\\tower.blend", "saves/tower.blend"),
        ("Turm (2) +ß", "Turm (2) +ß.blend"),
        ("v1.2", "v1.2.blend"),
        (".hidden", ".hidden.blend"),
    ],
)
def test_accepts_plain_file_names(folder: RunFolder, name: str, lies: str) -> None:
    assert folder.place_for(name, ".blend") == folder.root / lies


@pytest.mark.parametrize(
    "name",
    [
        *("", ".", "..", "/", "../tower", "a/../../tower", "/etc/passwd", "~/tower", "C:\\tower", "a//../b"),
        *("a\0b", "a\nb", "a:b", "x" * 200, "/".join("abcdefghij"), " ", "...", "a/ /b"),
    ],
)
def test_a_name_that_leads_elsewhere_is_refused(folder: RunFolder, name: str) -> None:
    with pytest.raises(Refusal, match="give a relative path such as"):
        folder.place_for(name, ".blend")


@pytest.mark.parametrize(
    "name", ["workspace/x", "checkpoints/000001", "private/x", "Workspace/x", "CHECKPOINTS/x"]
)
def test_refuses_to_save_in_reserved_folders(folder: RunFolder, name: str) -> None:
    with pytest.raises(Refusal, match="choose another folder"):
        folder.place_for(name, ".blend")


def test_refuses_links_that_lead_out_of_the_run(folder: RunFolder, outside: Path) -> None:
    (folder.root / "saves").symlink_to(outside.parent)
    with pytest.raises(Refusal, match="leads out"):
        folder.place_for("saves/secret", ".blend")


# One run, one worker


def test_refuses_a_second_lock_of_a_run(folder: RunFolder) -> None:
    with locked(folder.root), pytest.raises(Refusal, match="in use"), locked(folder.root):
        pass
    with locked(folder.root):
        pass


def test_a_lock_that_is_a_link_is_not_followed(folder: RunFolder, outside: Path) -> None:
    (folder.root / ".lock").symlink_to(outside)
    with pytest.raises(OSError, match="symbolic links"), locked(folder.root):
        pass
    assert outside.read_text() == "secret"


def test_a_session_in_a_folder_that_cannot_be_locked_says_which_and_why(folder: RunFolder) -> None:
    (folder.root / ".lock").mkdir()
    session = BlenderSession(SessionSetup(best_sandbox("none"), run=folder.root))
    use = session.use(scene_state.TOOL, {}, Call(), lambda _version: Knowledge(no_docs))
    with pytest.raises(CannotStart, match=r"cannot be used: \S+\.lock: Is a directory\."):
        asyncio.run(use)
    session.close()


def test_runs_started_in_one_second_get_their_own_folders(tmp_path: Path) -> None:
    with ThreadPoolExecutor(8) as threads:
        begun = list(threads.map(lambda _: new_root(tmp_path / "begun"), range(16)))
    assert len(set(begun)) == 16
    made = [new_run(tmp_path / "runs").root for _ in range(5)]
    assert len(set(made)) == 5
    assert all((root / "workspace").is_dir() and (root / "checkpoints").is_dir() for root in made)
