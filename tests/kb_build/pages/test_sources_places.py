"""Manual and guides are found where they are, in the order that people expect, of the version asked."""

from __future__ import annotations

import os
import shutil
import tarfile
import zipfile
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import SourceError
from kb_build.pages.sources import DocumentationSource, MissingSource, Origin, find_sources
from simworlds.errors import UserError
from simworlds.releases import releases, source_names

if TYPE_CHECKING:
    from pathlib import Path

RST_MANUAL = {"index.rst": "Manual\n", "physics/cloth.rst": "Cloth\n"}
RST_GUIDES = {"info_overview.rst": "Overview\n", "change_log.rst": "Log\n"}


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def html_manual(version: str) -> dict[str, str]:
    page = f"<html><title>Cloth - Blender {version} Manual</title><article>Cloth</article>"
    return {"index.html": page, "physics/cloth.html": page}


def html_guides(version: str) -> dict[str, str]:
    page = f"<html><title>Overview - Blender {version} Python API</title>"
    return {"index.html": page, "info_overview.html": page, "bpy.types.Object.html": page}


def tar(path: Path, inner: str, files: dict[str, str]) -> Path:
    folder = write(path.parent / "packing" / inner, files)
    with tarfile.open(path, "w:xz") as archive:
        archive.add(folder, inner)
    shutil.rmtree(path.parent / "packing")
    return path


def zipped(path: Path, inner: str, files: dict[str, str]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(f"{inner}/{name}", text)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "corpora").mkdir()
    return tmp_path / "corpora"


def look(
    version: str, tmp_path: Path, **places: Path | None
) -> dict[str, DocumentationSource | MissingSource]:
    found, missing = find_sources(version, cache=tmp_path / "cache", allow_download=False, **places)
    return {entry.role: entry for entry in (*found, *missing)}


def source(entry: DocumentationSource | MissingSource) -> DocumentationSource:
    assert isinstance(entry, DocumentationSource), entry
    return entry


def reason(entry: DocumentationSource | MissingSource) -> str:
    assert isinstance(entry, MissingSource), entry
    return entry.reason


def names(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_archives_in_the_corpora_folder_are_found_and_unpacked(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-5.1-rst.tar.xz", "blender-manual-5.1/manual", RST_MANUAL)
    tar(folder / "api-guides-5.1-rst.tar.xz", "blender-api-guides-5.1/rst", RST_GUIDES)
    found = look("5.1", tmp_path, corpora=folder)
    manual, guides = source(found["manual"]), source(found["guides"])
    assert (manual.form, manual.version, manual.given) == ("rst", "5.1", False)
    assert names(manual.path) == ["index.rst", "physics/cloth.rst"]
    assert names(guides.path) == ["change_log.rst", "info_overview.rst"]
    assert manual.origin == str(folder / "manual-5.1-rst.tar.xz")


def test_a_patch_version_finds_its_minor_versions_sources(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-5.1-rst.tar.xz", "blender-manual-5.1/manual", RST_MANUAL)
    assert source(look("5.1.2", tmp_path, corpora=folder)["manual"]).version == "5.1"


def test_the_official_downloads_are_known_by_their_names(tmp_path: Path, folder: Path) -> None:
    zipped(folder / "blender_manual_v510_en.zip", "blender_manual_v510_en.html", html_manual("5.1"))
    zipped(folder / "blender_python_reference_5_1.zip", "blender_python_reference_5_1", html_guides("5.1"))
    found = look("5.1", tmp_path, corpora=folder)
    manual, guides = source(found["manual"]), source(found["guides"])
    assert (manual.form, guides.form) == ("html", "html")
    assert names(guides.path) == ["index.html", "info_overview.html"]


def test_unpacked_folders_in_the_corpora_folder_are_found(tmp_path: Path, folder: Path) -> None:
    write(folder / "blender-manual-5.1" / "manual", RST_MANUAL)
    assert (
        source(look("5.1", tmp_path, corpora=folder)["manual"]).path == folder / "blender-manual-5.1/manual"
    )


def test_rst_is_preferred_to_html(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-4.4-html.tar.xz", "blender_manual_v440_en.html", html_manual("4.4"))
    tar(folder / "manual-4.4-rst.tar.xz", "blender-manual-4.4/manual", RST_MANUAL)
    assert source(look("4.4", tmp_path, corpora=folder)["manual"]).form == "rst"


def test_another_versions_manual_in_the_corpora_folder_is_left_alone(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-4.4-rst.tar.xz", "blender-manual-4.4/manual", RST_MANUAL)
    text = reason(look("5.1", tmp_path, corpora=folder)["manual"])
    assert str(folder) in text
    assert "MANUAL=PATH" in text


def test_a_manual_that_says_another_version_than_its_name_is_not_used(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-5.1-html.tar.xz", "manual", html_manual("4.4"))
    assert "holds Blender 4.4" in reason(look("5.1", tmp_path, corpora=folder)["manual"])


def test_a_manual_given_by_path_is_used_whatever_its_version(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-5.1-rst.tar.xz", "blender-manual-5.1/manual", RST_MANUAL)
    given = tar(tmp_path / "old.tar.xz", "blender_manual_v440_en.html", html_manual("4.4"))
    manual = source(look("5.1", tmp_path, corpora=folder, manual=given)["manual"])
    assert (manual.version, manual.given, manual.origin) == ("4.4", True, str(given))


@pytest.mark.parametrize(
    ("files", "inner", "version"),
    [
        ({"objects.inv": "# Sphinx inventory version 2\n# Project: X\n# Version: 4.3\n"}, "m", "4.3"),
        (
            {"objects.inv": "# Sphinx inventory version 2\n# Project: Blender 4.2 Manual\n# Version: \n"},
            "m",
            "4.2",
        ),
        ({"conf.py": "import os\nblender_version = '4.5'\n"}, "m", "4.5"),
        ({}, "blender-manual-5.0", "5.0"),
        ({}, "blender_manual_v420_en.html", "4.2"),
        ({}, "blender-manual-blender-v5.2-release", "5.2"),
        ({}, "some-pages", "unknown"),
    ],
)
def test_a_given_folder_tells_its_version(
    tmp_path: Path, files: dict[str, str], inner: str, version: str
) -> None:
    given = write(tmp_path / "given" / inner, RST_MANUAL | files)
    assert source(look("5.1", tmp_path, manual=given)["manual"]).version == version


def test_the_configuration_of_a_clone_is_read_and_not_run(tmp_path: Path) -> None:
    clone = tmp_path / "clone"
    write(clone / "manual", RST_MANUAL)
    write(clone, {"conf.py": "version = '4.5'\nraise SystemExit\n"})
    manual = source(look("5.1", tmp_path, manual=clone)["manual"])
    assert (manual.version, manual.path) == ("4.5", clone / "manual")


@pytest.mark.parametrize("deep", ["", "manual", "a/b/manual"])
def test_the_pages_are_found_below_the_folder_given(tmp_path: Path, deep: str) -> None:
    write(tmp_path / "given" / deep, RST_MANUAL)
    manual = source(look("5.1", tmp_path, manual=tmp_path / "given")["manual"])
    assert manual.path == (tmp_path / "given" / deep)


def test_guides_are_found_in_a_clone_of_blender(tmp_path: Path) -> None:
    clone = tmp_path / "blender-v5.1.2"
    write(clone / "doc" / "python_api" / "rst", RST_GUIDES)
    write(clone / "tests", {"index.rst": "no guide\n"})
    guides = source(look("5.1", tmp_path, guides=clone)["guides"])
    assert (guides.path.name, guides.version) == ("rst", "5.1")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: path, "does not exist"),
        (lambda path: write(path, {"notes.txt": "x"}), "no manual pages"),
        (lambda path: write(path.parent, {path.name: "not an archive"}) / path.name, "not an archive"),
        (lambda path: zipped(path, "x", {"logo.png": "x"}), "no manual pages"),
    ],
    ids=["missing", "folder without pages", "no archive", "archive without pages"],
)
def test_a_given_path_that_cannot_be_used_is_an_error(tmp_path: Path, make, message: str) -> None:
    with pytest.raises(SourceError, match=message) as caught:
        look("5.1", tmp_path, manual=make(tmp_path / "given"))
    assert str(tmp_path / "given") in str(caught.value)


def test_a_manual_given_as_guides_is_an_error(tmp_path: Path) -> None:
    given = write(tmp_path / "manual", RST_MANUAL)
    with pytest.raises(SourceError, match="no guides"):
        look("5.1", tmp_path, guides=given)


def test_a_damaged_archive_in_the_corpora_folder_is_named_and_the_next_one_used(
    tmp_path: Path, folder: Path
) -> None:
    (folder / "manual-5.1-rst.tar.xz").write_bytes(b"\xfd7zXZ\x00 damaged")
    assert "is damaged" in reason(look("5.1", tmp_path, corpora=folder)["manual"])
    tar(folder / "manual-5.1-html.tar.xz", "blender_manual_v510_en.html", html_manual("5.1"))
    assert source(look("5.1", tmp_path, corpora=folder)["manual"]).form == "html"


def test_sources_of_the_last_build_are_used_again(tmp_path: Path, folder: Path) -> None:
    archive = tar(folder / "somewhere.tar.xz", "manual", RST_MANUAL)
    before = {"manual": Origin(archive, given=True), "guides": Origin(folder / "gone.zip", given=False)}
    found, missing = find_sources("5.1", cache=tmp_path / "cache", before=before, allow_download=False)
    assert [(source.role, source.origin, source.given) for source in found] == [
        ("manual", str(archive), True)
    ]
    assert [one.role for one in missing] == ["guides"]


def test_a_corpora_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    assert "gone does not exist" in reason(look("5.1", tmp_path, corpora=tmp_path / "gone")["manual"])


def test_archives_are_unpacked_once(tmp_path: Path, folder: Path) -> None:
    tar(folder / "manual-5.1-rst.tar.xz", "blender-manual-5.1/manual", RST_MANUAL)
    first = source(look("5.1", tmp_path, corpora=folder)["manual"])
    mark = first.path / "mark"
    mark.touch()
    second = source(look("5.1", tmp_path, corpora=folder)["manual"])
    assert second == first
    assert mark.exists()


def test_a_changed_archive_is_noticed(tmp_path: Path, folder: Path) -> None:
    archive = tar(folder / "manual-5.1-rst.tar.xz", "blender-manual-5.1/manual", RST_MANUAL)
    first = source(look("5.1", tmp_path, corpora=folder)["manual"])
    tar(archive, "blender-manual-5.1/manual", RST_MANUAL | {"new.rst": "New\n"})
    second = source(look("5.1", tmp_path, corpora=folder)["manual"])
    assert second.sha256 != first.sha256
    assert "new.rst" in names(second.path)


def test_a_folders_digest_follows_its_pages_and_nothing_else(tmp_path: Path) -> None:
    given = write(tmp_path / "manual", RST_MANUAL)

    def digest() -> str:
        return source(look("5.1", tmp_path, manual=given)["manual"]).sha256

    first = digest()
    write(given, {"notes.txt": "not a page"})
    assert digest() == first
    write(given, {"physics/cloth.rst": "Changed\n"})
    changed = digest()
    assert changed != first
    (given / "physics" / "cloth.rst").rename(given / "physics" / "cloths.rst")
    assert digest() not in {first, changed}


def test_the_same_pages_elsewhere_have_the_same_digest(tmp_path: Path) -> None:
    one, two = write(tmp_path / "one", RST_MANUAL), write(tmp_path / "two", RST_MANUAL)
    os.utime(two / "index.rst", (1, 1))
    digests = {source(look("5.1", tmp_path, manual=path)["manual"]).sha256 for path in (one, two)}
    assert len(digests) == 1


def test_a_damaged_digest_cache_does_no_harm(tmp_path: Path) -> None:
    given = write(tmp_path / "manual", RST_MANUAL)
    first = look("5.1", tmp_path, manual=given)["manual"]
    for damage in ("{", "[]", '{"x": 3}', "\0"):
        (tmp_path / "cache" / "digests.json").write_text(damage)
        assert look("5.1", tmp_path, manual=given)["manual"] == first


@pytest.mark.parametrize("version", ["", "five", "5", "5.1.2.3", "5.1; rm", "../5.1", "5.1\n6"])
def test_an_invalid_version_is_refused(tmp_path: Path, version: str) -> None:
    with pytest.raises(UserError, match="is not a Blender version"):
        look(version, tmp_path)


def test_every_release_has_names_of_its_own() -> None:
    every = [name for entry in releases() for name in source_names("manual", entry.minor)]
    assert len(every) == len(set(every)) > 20


@pytest.mark.corpora
@pytest.mark.parametrize(("version", "pages"), [("5.1", 2200), ("4.4", 2013)])
def test_the_real_manual_is_found_whole(tmp_path: Path, corpora: Path, version: str, pages: int) -> None:
    manual = source(look(version, tmp_path, corpora=corpora)["manual"])
    assert manual.version == version
    assert sum(1 for _ in manual.path.rglob("*.rst")) == pages


@pytest.mark.corpora
def test_the_real_html_manual_tells_its_version(tmp_path: Path, corpora: Path) -> None:
    given = corpora / "manual-4.4-html.tar.xz"
    manual = source(look("5.1", tmp_path, manual=given)["manual"])
    assert (manual.version, manual.form, manual.path.name) == ("4.4", "html", "blender_manual_v440_en.html")
