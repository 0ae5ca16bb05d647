"""Where screenshots and delivered pictures may be written to, and what code is exchanged for."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from agents.blender.drop_in.delivery import Delivery
from agents.blender.drop_in.screenshot_places import ScreenshotPlaces
from agents.blender.files.run_folder import RunFolder
from simworlds.sandbox.errors import Refusal

PNG = b"\x89PNG\r\n\x1a\n and so on"


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stands for the temporary folder; a link leads to it, too."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    (tmp_path / "link").symlink_to(folder)
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path / "link"))
    return folder


def test_pictures_appear_whole_for_the_owner_alone(temporary: Path) -> None:
    places = ScreenshotPlaces()
    (temporary / "inner").mkdir()
    for folder in (temporary, temporary.with_name("link"), temporary / "inner"):
        places.write(str(folder / "shot.png"), PNG)
        assert (folder / "shot.png").read_bytes() == PNG
        assert (folder / "shot.png").stat().st_mode & 0o777 == 0o600
    assert {path.name for path in temporary.iterdir()} == {"inner", "shot.png"}


def test_a_further_folder_can_be_named(temporary: Path, tmp_path: Path) -> None:
    more = tmp_path / "more"
    more.mkdir()
    with pytest.raises(Refusal, match="--screenshots"):
        ScreenshotPlaces().write(str(more / "shot.png"), PNG)
    ScreenshotPlaces((more,)).write(str(more / "shot.png"), PNG)
    assert (more / "shot.png").read_bytes() == PNG


def test_pictures_and_empty_files_are_replaced(temporary: Path) -> None:
    for before in (b"", PNG + b"older"):
        (temporary / "shot.png").write_bytes(before)
        ScreenshotPlaces().write(str(temporary / "shot.png"), PNG)
        assert (temporary / "shot.png").read_bytes() == PNG


@pytest.mark.parametrize(
    "path", ["/etc/shot.png", "shot.png", "{}/../shot.png", "{}/shot.txt", "{}/.png", "{}", "", "{}/a\0.png"]
)
def test_other_paths_are_refused(temporary: Path, path: str) -> None:
    with pytest.raises(Refusal, match="cannot be written"):
        ScreenshotPlaces().write(path.replace("{}", str(temporary)), PNG)


def test_nothing_but_pictures_is_replaced_and_no_link_followed(temporary: Path, tmp_path: Path) -> None:
    precious = tmp_path / "precious.png"
    precious.write_bytes(b"not a picture")
    (temporary / "link.png").symlink_to(precious)
    (temporary / "out").symlink_to(tmp_path)
    (temporary / "folder.png").mkdir()
    os.mkfifo(temporary / "pipe.png")
    (temporary / "text.png").write_bytes(b"words")
    for name in ("link.png", "out/precious.png", "folder.png", "pipe.png", "text.png", "missing/shot.png"):
        with pytest.raises(Refusal, match="cannot be written"):
            ScreenshotPlaces().write(str(temporary / name), PNG)
    assert precious.read_bytes() == b"not a picture"
    assert (temporary / "link.png").is_symlink()
    assert (temporary / "text.png").read_bytes() == b"words"
    assert not list(temporary.glob(".*"))


def test_what_is_no_picture_is_not_written(temporary: Path) -> None:
    with pytest.raises(Refusal, match="not a PNG"):
        ScreenshotPlaces().write(str(temporary / "shot.png"), b"#!/bin/sh")
    assert not list(temporary.iterdir())


# Pictures of code


def test_paths_of_pictures_are_exchanged_and_nothing_else(temporary: Path, tmp_path: Path) -> None:
    folder = RunFolder.make(tmp_path / "run")
    delivery = Delivery(ScreenshotPlaces())
    kept = (
        f"'{temporary}/scene.blend', '/elsewhere{temporary}/a.png', '{temporary}/../a.png', '{temporary}/a.pngx', "
        f"'{temporary}.png', '/etc/a.png'"
    )
    assert delivery.exchanged(kept, folder) == kept
    code = f'p = \'{temporary}/x/shot.png\'; q = "{{\\"f\\": \\"{temporary}/look_12.png\\"}}"'
    exchanged = delivery.exchanged(code, folder)
    assert str(temporary) not in exchanged
    assert exchanged.count(folder.workspace.for_blender("to-deliver/")) == 2
    assert delivery.restored(exchanged) == code


def test_pictures_are_delivered_once_and_again_when_they_change(temporary: Path, tmp_path: Path) -> None:
    folder = RunFolder.make(tmp_path / "run")
    delivery = Delivery(ScreenshotPlaces())
    own = Path(delivery.exchanged(f"{temporary}/shot.png", folder))
    assert [str(own)] == delivery.targets
    own.parent.mkdir(parents=True)
    assert delivery.deliver(folder) == []
    own.write_bytes(PNG)
    assert delivery.deliver(folder) == []
    meant = temporary / "shot.png"
    assert meant.read_bytes() == PNG
    meant.unlink()  # as clients do when they have read it
    assert delivery.deliver(folder) == []
    assert not meant.exists()
    own.write_bytes(PNG + b"newer")
    delivery.deliver(folder)
    assert meant.read_bytes() == PNG + b"newer"
    own.write_bytes(b"words")
    assert ["not a PNG" in fault for fault in delivery.deliver(folder)] == [True]
    own.unlink()
    own.symlink_to("/etc/passwd")
    assert len(delivery.deliver(folder)) == 1
    assert meant.read_bytes() == PNG + b"newer"


def test_paths_of_the_run_itself_are_left_alone(temporary: Path) -> None:
    folder = RunFolder.make(temporary / "run")
    code = folder.workspace.for_blender("shot.png")
    assert Delivery(ScreenshotPlaces()).exchanged(code, folder) == code
