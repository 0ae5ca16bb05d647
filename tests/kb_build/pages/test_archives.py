"""Archives that nobody vouches for are unpacked whole, inside their folder, or not at all."""

from __future__ import annotations

import io
import os
import stat
import subprocess
import sys
import tarfile
import textwrap
import zipfile
from pathlib import Path, PurePosixPath

import pytest
from places import REPO

from kb_build.errors import SourceError
from kb_build.pages.archives import ArchiveLimits, safe_path, unpack

FILES = {
    "manual/index.rst": b"Title\n=====\n",
    "manual/physics/cloth.rst": b"Cloth\n",
    "manual/logo.png": b"\x89PNG",
}


def make_tar(path: Path, mode: str = "w:xz", files: dict[str, bytes] | None = None) -> Path:
    with tarfile.open(path, mode) as archive:
        for name, content in (FILES if files is None else files).items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return path


def make_zip(path: Path, files: dict[str, bytes] | None = None) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in (FILES if files is None else files).items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return path


def special_tar(path: Path, *members: tuple[str, bytes, str]) -> Path:
    with tarfile.open(path, "w") as archive:
        for name, kind, target in members:
            info = tarfile.TarInfo(name)
            info.type, info.linkname = kind, target
            archive.addfile(info)
        content = tarfile.TarInfo("out/page.rst")
        content.size = 4
        archive.addfile(content, io.BytesIO(b"page"))
    return path


def content_of(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def only(tmp_path: Path) -> list[str]:
    return sorted(entry.name for entry in tmp_path.iterdir())


@pytest.mark.parametrize(
    ("suffix", "mode"), [("tar", "w"), ("tar.gz", "w:gz"), ("tar.bz2", "w:bz2"), ("tar.xz", "w:xz")]
)
def test_a_tar_comes_out_as_it_went_in(tmp_path: Path, suffix: str, mode: str) -> None:
    archive = make_tar(tmp_path / f"a.{suffix}", mode)
    assert unpack(archive, tmp_path / "out") == 3
    assert content_of(tmp_path / "out") == FILES


def test_a_zip_comes_out_as_it_went_in(tmp_path: Path) -> None:
    assert unpack(make_zip(tmp_path / "a.zip"), tmp_path / "out") == 3
    assert content_of(tmp_path / "out") == FILES


def test_the_kind_is_told_by_content_not_by_name(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "really-a-zip.tar.xz")
    assert unpack(archive, tmp_path / "out") == 3


@pytest.mark.parametrize("make", [make_tar, make_zip])
def test_only_wanted_members_are_written(tmp_path: Path, make) -> None:
    archive = make(tmp_path / "a")
    unpack(archive, tmp_path / "out", wanted=lambda path: path.suffix == ".rst")
    assert sorted(content_of(tmp_path / "out")) == ["manual/index.rst", "manual/physics/cloth.rst"]


HOSTILE = {
    "parent": "../evil.rst",
    "parent inside": "manual/../../evil.rst",
    "absolute": "/tmp/evil.rst",
    "backslashes": "..\\..\\evil.rst",
    "drive": "C:/evil.rst",
    "drive-relative": "C:evil.rst",
    "alternate stream": "index.rst:evil",
    "UNC": "\\\\server\\share\\evil.rst",
    "wide dots": "．．/evil.rst",
    "one-character dots": "‥/evil.rst",
    "wide slash": "..／evil.rst",
    "new line": "manual/a\nb.rst",
    "right to left": "manual/\u202etsr.exe",
    "zero width": "manual/in\u200bdex.rst",
    "long": "a" * 300 + ".rst",
    "deep": "a/" * 60 + "b.rst",
}


@pytest.mark.parametrize("name", HOSTILE.values(), ids=HOSTILE)
@pytest.mark.parametrize("make", [make_tar, make_zip])
def test_an_archive_with_a_hostile_name_is_refused(tmp_path: Path, make, name: str) -> None:
    place = tmp_path / "deep" / "place"
    place.mkdir(parents=True)
    archive = make(place / "a", files={"manual/index.rst": b"fine", name: b"evil"})
    with pytest.raises(SourceError, match="do not use this archive"):
        unpack(archive, place / "out")
    assert only(place) == ["a"]
    assert only(tmp_path) == ["deep"]


def test_an_archive_with_an_undecodable_name_is_refused(tmp_path: Path) -> None:
    archive = make_tar(tmp_path / "a.tar", "w", {"manual/\udcff.rst": b"x"})
    with pytest.raises(SourceError, match="invisible characters"):
        unpack(archive, tmp_path / "out")


@pytest.mark.parametrize(
    "name", ["manual/ü/日本.rst", "./manual/a.rst", "manual//b c.rst", "manual/.hidden.rst"]
)
def test_ordinary_names_are_accepted(name: str) -> None:
    assert safe_path(name, Path("a.zip")) == PurePosixPath(name)


@pytest.mark.parametrize("kind", [tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.CHRTYPE, tarfile.FIFOTYPE])
def test_links_and_devices_are_never_made(tmp_path: Path, kind: bytes) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "page.rst").write_text("untouched")
    archive = special_tar(tmp_path / "a.tar", ("out", kind, str(outside)))
    unpack(archive, tmp_path / "here")
    assert (outside / "page.rst").read_text() == "untouched"
    assert content_of(tmp_path / "here") == {"out/page.rst": b"page"}
    assert not any(path.is_symlink() for path in (tmp_path / "here").rglob("*"))


def test_a_symbolic_link_in_a_zip_is_never_made(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        link = zipfile.ZipInfo("index.rst")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
        archive.writestr("other.rst", "fine")
    assert unpack(tmp_path / "a.zip", tmp_path / "out") == 1
    assert content_of(tmp_path / "out") == {"other.rst": b"fine"}


def test_files_come_out_without_the_archives_permissions(tmp_path: Path) -> None:
    with tarfile.open(tmp_path / "a.tar", "w") as archive:
        info = tarfile.TarInfo("run.rst")
        info.mode = 0o4777
        archive.addfile(info)
    unpack(tmp_path / "a.tar", tmp_path / "out")
    assert stat.S_IMODE((tmp_path / "out" / "run.rst").stat().st_mode) & 0o7111 == 0


@pytest.mark.parametrize("make", [make_tar, make_zip])
@pytest.mark.parametrize(
    "limits",
    [ArchiveLimits(total_bytes=1 << 20), ArchiveLimits(ratio=2, free_bytes=1 << 20)],
    ids=["total", "ratio"],
)
def test_a_bomb_is_stopped(tmp_path: Path, make, limits: ArchiveLimits) -> None:
    archive = make(tmp_path / "a", files={"index.rst": bytes(8 << 20)})
    with pytest.raises(SourceError, match="as bombs do"):
        unpack(archive, tmp_path / "out", limits=limits)
    assert only(tmp_path) == ["a"]


def test_a_bomb_of_unwanted_members_is_stopped(tmp_path: Path) -> None:
    archive = make_tar(tmp_path / "a", files={"big.bin": bytes(8 << 20), "index.rst": b"x"})
    with pytest.raises(SourceError, match="as bombs do"):
        unpack(
            archive,
            tmp_path / "out",
            wanted=lambda path: path.suffix == ".rst",
            limits=ArchiveLimits(1 << 20),
        )


def test_a_zip_with_false_sizes_is_stopped(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip", files={"index.rst": bytes(8 << 20)})
    data = bytearray(archive.read_bytes())
    entry = data.index(b"PK\x01\x02")
    data[entry + 24 : entry + 28] = (10).to_bytes(4, "little")
    archive.write_bytes(data)
    with pytest.raises(SourceError, match="damaged"):
        unpack(archive, tmp_path / "out", limits=ArchiveLimits(total_bytes=1 << 20))
    assert only(tmp_path) == ["a.zip"]


@pytest.mark.parametrize("make", [make_tar, make_zip])
def test_a_flood_of_members_is_stopped(tmp_path: Path, make) -> None:
    archive = make(tmp_path / "a", files={f"{i}.rst": b"" for i in range(60)})
    with pytest.raises(SourceError, match="more than 50 members"):
        unpack(archive, tmp_path / "out", limits=ArchiveLimits(members=50))
    assert only(tmp_path) == ["a"]


def test_a_header_that_would_fill_the_memory_is_refused(tmp_path: Path) -> None:
    header = tarfile.TarInfo("x")
    header.type, header.size = tarfile.XHDTYPE, 1 << 30
    with tarfile.open(tmp_path / "a.tar", "w") as archive:
        archive.addfile(header)
    with pytest.raises(SourceError, match="impossible length"):
        unpack(tmp_path / "a.tar", tmp_path / "out")


def test_chained_headers_do_not_exhaust_the_stack(tmp_path: Path) -> None:
    header = tarfile.TarInfo("x")
    header.type, header.size = tarfile.GNUTYPE_LONGNAME, 4
    block = header.tobuf() + b"abc\0" + bytes(508)
    (tmp_path / "a.tar").write_bytes(block * 20_000 + bytes(1024))
    with pytest.raises(SourceError, match="damaged"):
        unpack(tmp_path / "a.tar", tmp_path / "out")


@pytest.mark.parametrize("mode", ["w", "w:gz", "w:bz2", "w:xz"])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_a_truncated_tar_is_an_error_not_a_shorter_manual(tmp_path: Path, mode: str, share: float) -> None:
    archive = make_tar(tmp_path / "a", mode, {f"{i}.rst": os.urandom(2_000) for i in range(40)})
    data = archive.read_bytes()
    archive.write_bytes(data[: int(len(data) * share) // 512 * 512])
    with pytest.raises(SourceError, match="damaged"):
        unpack(archive, tmp_path / "out")
    assert only(tmp_path) == ["a"]


def test_a_truncated_zip_is_an_error(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip")
    archive.write_bytes(archive.read_bytes()[:-30])
    with pytest.raises(SourceError, match="damaged"):
        unpack(archive, tmp_path / "out")


def test_flipped_bytes_are_noticed(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip", {"index.rst": os.urandom(5_000)})
    data = bytearray(archive.read_bytes())
    data[2_000] ^= 0xFF
    archive.write_bytes(data)
    with pytest.raises(SourceError, match="damaged"):
        unpack(archive, tmp_path / "out")
    assert only(tmp_path) == ["a.zip"]


@pytest.mark.parametrize(
    "content",
    [b"", b"<html>not an archive</html>", b"PK\x03\x04junk", b"\x1f\x8bjunk", b"\xfd7zXZ\x00junk"],
    ids=["empty", "page", "zip", "gzip", "xz"],
)
def test_a_file_that_is_not_an_archive_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a").write_bytes(content)
    with pytest.raises(SourceError, match="damaged or not an archive") as caught:
        unpack(tmp_path / "a", tmp_path / "out")
    assert str(tmp_path / "a") in str(caught.value)
    assert only(tmp_path) == ["a"]


def test_an_encrypted_zip_is_named_as_unreadable(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip", {"index.rst": b"secret"})
    data = bytearray(archive.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    data[6] |= 1
    archive.write_bytes(data)
    with pytest.raises(SourceError, match="encrypted"):
        unpack(archive, tmp_path / "out")


def test_zstandard_is_named_with_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "a.tar.zst").write_bytes(b"\x28\xb5\x2f\xfd" + bytes(100))
    with pytest.raises(SourceError, match=r"repack it as \.tar\.xz"):
        unpack(tmp_path / "a.tar.zst", tmp_path / "out")


def test_an_interrupt_leaves_nothing_behind(tmp_path: Path) -> None:
    archive = make_tar(tmp_path / "a")

    def interrupt(what: str, done: int, total: int | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        unpack(archive, tmp_path / "out", progress=interrupt)
    assert only(tmp_path) == ["a"]


def test_leftovers_of_a_killed_process_are_removed(tmp_path: Path) -> None:
    archive = make_tar(tmp_path / "a")
    script = f"""
        import os, pathlib, signal
        from kb_build.pages.archives import unpack
        kill = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
        unpack(pathlib.Path({str(archive)!r}), pathlib.Path({str(tmp_path / "out")!r}), progress=kill)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], cwd=REPO, check=False)
    assert done.returncode < 0
    assert len(only(tmp_path)) == 2
    unpack(archive, tmp_path / "out")
    assert only(tmp_path) == ["a", "out"]


def test_a_full_disk_is_named_and_leaves_nothing_behind(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip", {"index.rst": os.urandom(1 << 20)})
    script = f"""
        import pathlib, resource
        from kb_build.pages.archives import unpack
        from kb_build.errors import SourceError
        resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
        try:
            unpack(pathlib.Path({str(archive)!r}), pathlib.Path({str(tmp_path / "out")!r}))
        except SourceError as error:
            print(error)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], cwd=REPO, capture_output=True, text=True, check=False
    )
    assert "disk is full" in done.stdout, done.stderr
    assert "make room" in done.stdout
    assert only(tmp_path) == ["a.zip"]


def test_progress_is_reported_in_bytes_of_the_archive(tmp_path: Path) -> None:
    archive = make_zip(tmp_path / "a.zip", {f"{i}.rst": os.urandom(9_000) for i in range(10)})
    seen: list[tuple[str, int, int | None]] = []
    unpack(archive, tmp_path / "out", progress=lambda *report: seen.append(report))
    size = archive.stat().st_size
    assert [done for _, done, _ in seen] == sorted(done for _, done, _ in seen)
    assert seen[-1][1] <= size
    assert {(what, total) for what, _, total in seen} == {("unpacking a.zip", size)}


def test_a_missing_archive_is_named(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"nowhere\.zip"):
        unpack(tmp_path / "nowhere.zip", tmp_path / "out")
