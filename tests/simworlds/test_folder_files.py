"""Of a folder that somebody else filled, only regular files are read, and no more than is allowed."""

from __future__ import annotations

import os
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import pytest

from simworlds.folder_files import FolderLimits, FolderTooLarge, list_files, read_file

if TYPE_CHECKING:
    from pathlib import Path

MIB = 1 << 20


def is_page(path: PurePosixPath) -> bool:
    return path.suffix == ".rst"


def write(path: Path, text: str = "x") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "given").mkdir()
    return tmp_path / "given"


def names(folder: Path, **limits: int) -> list[str]:
    return [file.name for file in list_files(folder, is_page, FolderLimits(**limits)).files]


def test_wanted_files_are_listed_by_name_with_their_sizes(folder: Path) -> None:
    write(folder / "b.rst", "four")
    write(folder / "a" / "c.rst")
    write(folder / "a" / "picture.png")
    write(folder / ".git" / "d.rst")
    found = list_files(folder, is_page)
    assert [(file.name, file.size) for file in found.files] == [("a/c.rst", 1), ("b.rst", 4)]
    assert found.passed_over() == ""


def test_links_are_passed_over_wherever_they_lead(folder: Path, tmp_path: Path) -> None:
    secret = write(tmp_path / "outside" / "secret.rst")
    write(folder / "page.rst")
    (folder / "file.rst").symlink_to(secret)
    (folder / "folder").symlink_to(secret.parent)
    (folder / "inside.rst").symlink_to(folder / "page.rst")
    (folder / "circle").symlink_to(folder)
    (folder / "nowhere.rst").symlink_to(tmp_path / "gone")
    found = list_files(folder, is_page)
    assert [file.name for file in found.files] == ["page.rst"]
    assert found.passed_over() == "5 links"


def test_names_that_are_no_text_are_passed_over(folder: Path) -> None:
    write(folder / "café.rst")
    write(folder / os.fsdecode(b"caf\xe9.rst"))
    write(folder / os.fsdecode(b"d\xe9\xe8") / "page.rst")
    found = list_files(folder, is_page)
    assert [file.name for file in found.files] == ["café.rst"]
    assert found.passed_over() == "2 names that are not UTF-8"


def test_the_folder_itself_may_be_reached_through_a_link(folder: Path, tmp_path: Path) -> None:
    write(folder / "page.rst", "text")
    (tmp_path / "link").symlink_to(folder)
    assert names(tmp_path / "link") == ["page.rst"]
    assert read_file(tmp_path / "link", "page.rst", most=10) == b"text"


def test_a_pipe_is_neither_listed_nor_waited_for(folder: Path) -> None:
    os.mkfifo(folder / "pipe.rst")
    found = list_files(folder, is_page)
    assert (found.files, found.passed_over()) == ([], "1 entry that is neither file nor folder")
    with pytest.raises(OSError, match="not a regular file"):
        read_file(folder, "pipe.rst", most=10)


def test_a_file_that_became_a_link_is_not_read(folder: Path, tmp_path: Path) -> None:
    secret = write(tmp_path / "secret.rst")
    write(folder / "sub" / "page.rst")
    (file,) = list_files(folder, is_page).files
    (folder / file.name).unlink()
    (folder / file.name).symlink_to(secret)
    with pytest.raises(OSError, match="symbolic links"):
        read_file(folder, file.name, most=10)


def test_a_folder_that_became_a_link_is_not_entered(folder: Path, tmp_path: Path) -> None:
    write(tmp_path / "outside" / "page.rst")
    (folder / "sub").symlink_to(tmp_path / "outside")
    with pytest.raises(OSError, match=r"Not a directory|symbolic links"):
        read_file(folder, "sub/page.rst", most=10)


@pytest.mark.parametrize("name", ["../secret.rst", "/etc/hostname", "sub/../../secret.rst", ""])
def test_a_name_that_leads_out_is_refused(folder: Path, tmp_path: Path, name: str) -> None:
    write(tmp_path / "secret.rst")
    write(folder / "sub" / "page.rst")
    with pytest.raises(OSError, match="does not lie beneath"):
        read_file(folder, name, most=10)


def test_a_file_without_end_is_passed_over_by_its_size(folder: Path) -> None:
    with (folder / "sparse.rst").open("wb") as file:
        file.truncate(1 << 40)
    write(folder / "page.rst")
    found = list_files(folder, is_page, FolderLimits(file_bytes=MIB))
    assert [file.name for file in found.files] == ["page.rst"]
    assert found.passed_over() == "1 file that is too large"


def test_a_file_that_grew_is_not_read_whole(folder: Path) -> None:
    write(folder / "page.rst", "12345")
    assert read_file(folder, "page.rst", most=5) == b"12345"
    assert read_file(folder, "page.rst", most=4, cut=True) == b"1234"
    with pytest.raises(OSError, match="more than 4 bytes"):
        read_file(folder, "page.rst", most=4)


def test_folders_are_entered_down_to_a_depth(folder: Path) -> None:
    write(folder / "a" / "b" / "page.rst")
    write(folder / "a" / "b" / "c" / "page.rst")
    found = list_files(folder, is_page, FolderLimits(depth=2))
    assert [file.name for file in found.files] == ["a/b/page.rst"]
    assert found.passed_over() == "1 folder that lies too deep"


@pytest.mark.parametrize(
    ("limits", "what"),
    [
        (FolderLimits(files=2), "2 files"),
        (FolderLimits(entries=2), "2 entries"),
        (FolderLimits(total_bytes=2 * MIB), "2 MiB"),
    ],
)
def test_a_folder_beyond_its_limits_is_condemned(folder: Path, limits: FolderLimits, what: str) -> None:
    for name in "abc":
        write(folder / f"{name}.rst", "x" * MIB)
    with pytest.raises(FolderTooLarge, match=f"more than {what}"):
        list_files(folder, is_page, limits)


def test_files_of_a_folder_within_are_named_from_there(folder: Path) -> None:
    write(folder / "manual" / "sub" / "page.rst", "text")
    write(folder / "manuals" / "other.rst")
    inner = list_files(folder, is_page).beneath(PurePosixPath("manual"))
    assert [file.name for file in inner.files] == ["sub/page.rst"]
    assert read_file(inner.folder, "sub/page.rst", most=10) == b"text"
