"""What a build puts together, and what it leaves alone."""

from __future__ import annotations

import json
import re
import shutil
import sqlite3
import tarfile
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from kb_build.errors import SourceError
from kb_build.pages.page import page_from_json
from kb_build.pipeline import BuildOptions, build
from kb_build.schema import unpack
from kb_build.symbols.records import symbol_from_json

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built

pytestmark = pytest.mark.blender


def rows(path: Path, sql: str, *values: object) -> list[Any]:
    with closing(sqlite3.connect(path)) as connection:
        return connection.execute(sql, values).fetchall()


def stamp(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_mtime_ns, status.st_ino


def test_a_base_holds_what_blender_and_both_sources_say(built: Built) -> None:
    record = rows(built.path, "SELECT record FROM symbols WHERE path = 'bpy.types.ClothSettings.quality'")
    quality = symbol_from_json(unpack(record[0][0]))
    assert (quality.type, quality.hard_min) == ("int", 1)
    sources = dict(rows(built.path, "SELECT source, count(*) FROM pages GROUP BY source"))
    assert sources["manual"] >= 10
    assert sources["guide"] == 2
    assert sources["template"] > 30
    assert rows(built.path, "SELECT count(*) FROM pages WHERE summary = ''") == [(0,)]
    # Blender's own templates are those that summaries ship for; the pages of these sources are not.
    by_source = dict(rows(built.path, "SELECT source, max(summary_method) FROM pages GROUP BY source"))
    assert by_source["manual"] == "extractive"


def test_a_base_names_its_sources(built: Built, blender_version: str) -> None:
    meta = dict(rows(built.path, "SELECT name, value FROM meta"))
    assert meta["blender"] == blender_version
    assert meta["minor"] == built.minor
    assert re.fullmatch(r"[0-9a-f]{64}", meta["fingerprint"])
    sources = {one["role"]: one for one in json.loads(meta["sources"])}
    assert sources["manual"]["form"] == "rst"
    assert sources["manual"]["version"] == built.minor
    assert sources["manual"]["pages"] >= 10
    assert re.fullmatch(r"[0-9a-f]{64}", sources["guides"]["sha256"])
    assert json.loads(meta["missing"]) == json.loads(meta["faults"]) == []
    counts = json.loads(meta["counts"])
    assert counts["symbols"]["operator"] > 2000
    assert counts["classes"]["data"] > 1500
    assert "cycles" in json.loads(meta["addons"])
    assert any(slug.startswith("troubleshooting/") for slug in json.loads(meta["page_warnings"]))


def test_nothing_is_done_when_nothing_has_changed(small: Built) -> None:
    before = stamp(small.path)
    report = build(None, options=small.options, home=small.home)
    assert not report.built
    assert report.meta["fingerprint"] == small.report.meta["fingerprint"]
    assert stamp(small.path) == before


def test_changed_pages_make_a_new_base_without_asking_blender_again(small: Built) -> None:
    """Of two pages with one name, the manual's is kept, and the other named."""
    extract = next((small.home / "extracts").glob("*.jsonl"))
    before = stamp(extract)
    page = small.corpora / f"manual-{small.minor}-rst" / "physics" / "index.rst"
    page.write_text(page.read_text() + "\nWobbling jelly is simulated, too.\n")
    guides = small.corpora / f"api-guides-{small.minor}-rst"
    (guides / "index.rst").write_text("Guides\n======\n\n.. toctree::\n\n   info_overview\n   info_traps\n")
    report = build(None, options=small.options, home=small.home)
    assert report.built
    records = rows(small.path, "SELECT slug, record FROM pages")
    assert [slug for slug, record in records if "Wobbling jelly" in page_from_json(unpack(record)).text] == [
        "physics/index"
    ]
    assert stamp(extract) == before
    assert rows(small.path, "SELECT source FROM pages WHERE slug = 'index'") == [("manual",)]
    assert any("two pages are called index" in warning for warning in report.warnings)


def test_pages_are_not_read_again_when_only_an_option_changes(small: Built) -> None:
    kept = {path: stamp(path) for path in (small.home / "cache" / "pages").iterdir()}
    assert len(kept) == 2
    report = build(None, options=replace(small.options, summaries="none"), home=small.home)
    assert report.built
    assert rows(small.path, "SELECT count(*) FROM pages WHERE summary != ''") == [(0,)]
    assert {path: stamp(path) for path in (small.home / "cache" / "pages").iterdir()} == kept


def test_force_asks_blender_and_builds_again_what_has_not_changed(small: Built, tmp_path: Path) -> None:
    """Of a program that says of its API what Blender said, of few symbols, and that it has no scripts to be read."""
    (extract,) = (small.home / "extracts").glob("*.jsonl")
    blender, asked, said, home = (tmp_path / name for name in ("blender", "asked", "said", "theirs"))
    said.write_text(re.sub(r',"scripts":"[^"]+"', "", extract.read_text(), count=1))
    assert said.stat().st_size < extract.stat().st_size
    blender.write_text(
        f'#!/bin/sh\n[ "$1" = --version ] && echo "Blender {small.report.version}" && exit\n'
        f"for word; do last=$word; done\necho >> {asked}\ncp {said} $last\n"
    )
    blender.chmod(0o755)
    options = BuildOptions(blender_exe=blender, pages=False)
    first = build(small.minor, options=options, home=home)
    before = stamp(first.path)
    assert not build(small.minor, options=options, home=home).built
    assert asked.read_text() == "\n"
    report = build(small.minor, options=replace(options, force=True), home=home)
    assert report.built
    assert report.meta["fingerprint"] == first.meta["fingerprint"]
    assert stamp(first.path) != before
    assert asked.read_text() == "\n\n"


def test_a_damaged_base_is_built_again_and_damaged_pages_in_the_cache_are_read_again(small: Built) -> None:
    for path in (small.home / "cache" / "pages").iterdir():
        path.write_bytes(path.read_bytes()[:100])
    data = small.path.read_bytes()
    small.path.write_bytes(data[: len(data) // 2])
    report = build(None, options=small.options, home=small.home)
    assert report.built
    assert small.path.stat().st_size > len(data) // 2
    assert json.loads(report.meta["counts"]) == json.loads(small.report.meta["counts"])


def test_a_missing_source_and_one_of_another_version_are_named_in_the_report_and_in_the_base(
    small: Built,
) -> None:
    guides = small.corpora / f"api-guides-{small.minor}-rst"
    guides.rename(small.corpora / "elsewhere")
    other = small.corpora / "manual-4.4-rst"
    (small.corpora / f"manual-{small.minor}-rst").rename(other)
    small.path.unlink()  # it has pages of the guides, which would be kept
    report = build(None, options=replace(small.options, manual=other), home=small.home)
    assert report.built
    assert [one.role for one in report.missing] == ["guides"]
    assert any("--guides PATH" in warning for warning in report.warnings)
    recorded = json.loads(report.meta["missing"])
    assert [one["role"] for one in recorded] == ["guides"]
    assert recorded[0]["reason"] == report.missing[0].reason
    assert any("is of Blender 4.4" in warning for warning in report.warnings)
    manual = next(one for one in json.loads(report.meta["sources"]) if one["role"] == "manual")
    assert (manual["version"], manual["given"]) == ("4.4", True)
    assert rows(small.path, "SELECT DISTINCT version FROM pages WHERE source = 'manual'") == [("4.4",)]


def test_a_required_source_that_is_missing_is_an_error_and_the_old_base_stands(small: Built) -> None:
    before = stamp(small.path)
    (small.corpora / f"manual-{small.minor}-rst").rename(small.corpora / "elsewhere")
    with pytest.raises(SourceError, match="required"):
        build(None, options=replace(small.options, require=frozenset({"manual"})), home=small.home)
    assert stamp(small.path) == before


def test_a_base_with_pages_is_not_replaced_by_one_that_lacks_them(small: Built) -> None:
    before = stamp(small.path)
    (small.corpora / f"manual-{small.minor}-rst").rename(small.corpora / "elsewhere")
    with pytest.raises(SourceError, match=r"has pages of the manual.*kept as it is.*--manual PATH.*--force"):
        build(None, options=small.options, home=small.home)
    assert stamp(small.path) == before


def test_a_base_can_be_built_without_pages_into_any_file(small: Built, tmp_path: Path) -> None:
    output = tmp_path / "else" / "where.sqlite"
    options = BuildOptions(pages=False, output=output)
    report = build(small.minor, options=options, home=small.home)
    assert report.path == output
    assert rows(output, "SELECT DISTINCT source FROM pages") == [("template",)]
    assert json.loads(report.meta["missing"]) == []
    assert not build(small.minor, options=options, home=small.home).built


@pytest.mark.corpora
def test_a_part_of_the_real_manual_and_the_real_guides_are_built(corpora: Path, small: Built) -> None:
    """The chapters about physics, without which the others' references to them would be the only ones."""
    if small.minor != "5.1":
        pytest.skip("the sources here are of Blender 5.1")
    manual = small.corpora / "manual-5.1-rst"
    shutil.rmtree(manual)
    with tarfile.open(corpora / "manual-5.1-rst.tar.xz") as files:
        for member in files:
            steps = member.name.split("/")
            if "physics" in steps or len(steps) < 4:
                files.extract(member, small.corpora / "part", filter="data")
    min((small.corpora / "part").rglob("index.rst"), key=lambda path: len(path.parts)).parent.rename(manual)
    shutil.rmtree(small.corpora / "part")
    guides = corpora / "api-guides-5.1-rst.tar.xz"
    options = replace(small.options, guides=guides, require=frozenset({"manual", "guides"}))
    report = build("5.1", options=options, home=small.home)
    counts = json.loads(report.meta["counts"])
    assert counts["pages"]["manual"] >= 90
    assert counts["pages"]["guide"] >= 14
    assert report.warnings == ()


@pytest.mark.whole
@pytest.mark.corpora
@pytest.mark.timeout(600)
def test_the_real_manual_and_guides_are_built_whole(
    corpora: Path, built_once: Built, tmp_path: Path, blender_version: str
) -> None:
    if not blender_version.startswith("5.1."):
        pytest.skip("the sources here are of Blender 5.1")
    options = BuildOptions(corpora=corpora, offline=True, require=frozenset({"manual", "guides"}))
    home = tmp_path / "home"
    shutil.copytree(built_once.home / "extracts", home / "extracts")
    report = build("5.1", options=options, home=home)
    counts = json.loads(report.meta["counts"])
    assert counts["pages"]["manual"] >= 2190
    assert counts["pages"]["guide"] >= 14
    assert report.warnings == ()
    assert report.path.stat().st_size < 75e6
