"""Ready bases: packed, fetched over HTTP and from files, and refused where they are not what they say."""

from __future__ import annotations

import hashlib
import io
import json
import lzma
import shutil
import sqlite3
import subprocess
import sys
import tarfile
import threading
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from download_site import Handler, Site
from places import REPO

from kb_build.base_file import read_meta
from kb_build.base_report import base_facts, base_lines
from kb_build.cli import kb
from kb_build.errors import FetchedElsewhere, KBBuildError, ReadyBaseError, StoreError
from kb_build.ready.export import Exported, export_base
from kb_build.ready.fetch import fetch_base
from kb_serve.knowledge_base import KnowledgeBase
from simworlds.folder_lock import locked

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

MEMBERS = ("manifest.json", "NOTICE.txt", "base.sqlite")


@dataclass(frozen=True)
class Ready:
    """A ready base as it was exported, and its version."""

    exported: Exported
    content: bytes

    @property
    def minor(self) -> str:
        return self.exported.manifest.minor

    @property
    def name(self) -> str:
        return f"/blender-{self.minor}.tar.xz"


@pytest.fixture(scope="module")
def source_base(small_base: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base like ``small_base`` without other versions' names and the uses, most of what packing would take."""
    path = tmp_path_factory.mktemp("source") / small_base.name
    shutil.copyfile(small_base, path)
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for table in ("removed", "removed_names", "successors", "similar_names", "uses", "use_counts"):
            connection.execute(f"DELETE FROM {table}")
        connection.execute("VACUUM")
    return path


@pytest.fixture(scope="module")
def ready(source_base: Path, tmp_path_factory: pytest.TempPathFactory) -> Ready:
    exported = export_base(source_base, tmp_path_factory.mktemp("ready") / "ready.tar.xz")
    return Ready(exported, exported.path.read_bytes())


@pytest.fixture
def site(ready: Ready) -> Iterator[Site]:
    server = Site(files={ready.name: ready.content})
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.released.set()
    server.shutdown()
    server.server_close()
    thread.join()


def unpacked(content: bytes) -> dict[str, bytes]:
    with tarfile.open(fileobj=io.BytesIO(content)) as archive:
        return {member.name: archive.extractfile(member).read() for member in archive}  # type: ignore[union-attr]


def packed(members: Mapping[str, bytes], *more: tarfile.TarInfo) -> bytes:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w") as archive:
        for name, content in members.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
        for member in more:
            archive.addfile(member)
    return lzma.compress(data.getvalue(), preset=0)


def described(members: Mapping[str, bytes], **changes: object) -> dict[str, bytes]:
    """The members with a manifest that is true of the base, but for the changes."""
    base = members["base.sqlite"]
    true = {"size": len(base), "sha256": hashlib.sha256(base).hexdigest()}
    manifest = {**json.loads(members["manifest.json"]), **true, **changes}
    return {**members, "manifest.json": json.dumps(manifest).encode()}


def changed_base(content: bytes, folder: Path, *statements: str) -> bytes:
    """A ready base whose base had the statements run on it; its manifest is true."""
    members = unpacked(content)
    path = folder / "changed.sqlite"
    path.write_bytes(members["base.sqlite"])
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for statement in statements:
            connection.execute(statement)
    return packed(described({**members, "base.sqlite": path.read_bytes()}))


def test_a_folder_in_the_place_of_the_base_is_told_before_anything_is_fetched(tmp_path: Path) -> None:
    target = tmp_path / "kb" / "blender-5.1.sqlite"
    target.mkdir(parents=True)
    with pytest.raises(KBBuildError, match=r"is a folder.*Remove it"):
        fetch_base("5.1", str(tmp_path / "absent.tar.xz"), home=tmp_path)


def refused(tmp_path: Path, content: bytes, minor: str) -> str:
    """What a file with that content is refused with; nothing of it stays."""
    path, home = tmp_path / "given.tar.xz", tmp_path / "home"
    path.write_bytes(content)
    with pytest.raises(KBBuildError) as caught:
        fetch_base(minor, str(path), home=home)
    left = [entry for entry in home.rglob("*") if entry.is_file()] if home.is_dir() else []
    assert left == []
    return str(caught.value)


# Export


def test_the_manifest_is_true_and_names_licences_and_authors(ready: Ready) -> None:
    members = unpacked(ready.content)
    manifest = json.loads(members["manifest.json"])
    assert tuple(members) == MEMBERS
    assert manifest["sha256"] == hashlib.sha256(members["base.sqlite"]).hexdigest()
    assert manifest["size"] == len(members["base.sqlite"])
    by_licence = {row["licence"]: row["attribution"] for row in manifest["licences"]}
    assert "Blender Documentation Team" in by_licence["CC-BY-SA-4.0"]
    assert {"CC-BY-SA-4.0", "GPL-3.0-or-later"} == set(by_licence)
    assert b"CC-BY-SA-4.0" in members["NOTICE.txt"]


def test_no_folder_of_this_machine_is_in_it(source_base: Path, ready: Ready) -> None:
    base = unpacked(ready.content)["base.sqlite"]
    meta = read_meta(source_base)
    places = [row["origin"] for row in json.loads(meta["sources"])]
    places.append(json.loads(meta["runtime"])["executable"])
    assert len(places) == 3
    assert not [place for place in places if place.encode() in base]


def test_what_was_missing_or_failed_is_told_without_the_places(source_base: Path, tmp_path: Path) -> None:
    here = "/srv/somebody/their work"
    rows = {
        "missing": [{"role": "guides", "reason": f"no API guides: {here}/corpora has none"}],
        "faults": [
            f"context: Traceback\n  File \"{here}/a.py\", line 1, in <module>\nKeyError: '{here}'\n",
            "new things: Blender crashed in make_cloth",
        ],
    }
    base = tmp_path / "base.sqlite"
    shutil.copyfile(source_base, base)
    with closing(sqlite3.connect(base, isolation_level=None)) as connection:
        for name, value in rows.items():
            connection.execute("UPDATE meta SET value = ? WHERE name = ?", (json.dumps(value), name))
    exported = export_base(base, tmp_path / "ready.tar.xz")
    content = unpacked(exported.path.read_bytes())["base.sqlite"]
    assert here.encode() not in content
    base.write_bytes(content)
    told = "\n".join(base_lines(base_facts(base)))
    assert "guides: this base was made without; build it anew with --guides PATH" in told
    assert "KeyError" in told
    assert "Blender crashed in make_cloth" in told


def test_what_is_no_base_is_not_packed(tmp_path: Path) -> None:
    path = tmp_path / "other.sqlite"
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("CREATE TABLE t (x)")
    with pytest.raises(StoreError, match=r"other\.sqlite"):
        export_base(path, tmp_path / "out.tar.xz")
    assert not (tmp_path / "out.tar.xz").exists()


# Fetching


def resumed_at(wanted: str | None) -> int:
    return int((wanted or "bytes=0-").removeprefix("bytes=").removesuffix("-"))


def test_a_fetched_base_answers_as_the_one_that_was_packed(
    source_base: Path, ready: Ready, site: Site, tmp_path: Path
) -> None:
    seen: list[tuple[str, int, int | None]] = []
    fetched = fetch_base(
        ready.minor,
        site.url,
        home=tmp_path,
        progress=lambda label, done, total: seen.append((label, done, total)),
    )
    with KnowledgeBase(fetched.path) as theirs, KnowledgeBase(source_base) as ours:
        assert theirs.query("ClothSettings.quality").text == ours.query("ClothSettings.quality").text
    assert any(label.startswith("downloading") and done == total for label, done, total in seen)
    assert [path.name for path in (tmp_path / "cache" / "bases").iterdir()] == [".lock"]


def test_the_command_exports_the_same_bytes_again_and_fetches_from_them(
    source_base: Path, ready: Ready, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "theirs"))
    file = tmp_path / "out.tar.xz"
    exported = CliRunner().invoke(kb, ["export", str(source_base), "--output", str(file)])
    assert exported.exit_code == 0, exported.output
    assert file.read_bytes() == ready.content
    pinned = next(word.strip("'") for word in exported.output.split() if "#sha256=" in word)
    assert pinned.endswith(f"#sha256={hashlib.sha256(ready.content).hexdigest()}")
    assert ready.exported.sha256 in pinned
    fetched = CliRunner().invoke(kb, ["fetch", ready.minor, "--from", pinned])
    assert fetched.exit_code == 0, fetched.output
    assert "CC-BY-SA-4.0" in fetched.output
    assert (tmp_path / "theirs" / "kb" / f"blender-{ready.minor}.sqlite").is_file()


def test_a_transfer_that_breaks_off_is_continued(ready: Ready, site: Site, tmp_path: Path) -> None:
    half = len(ready.content) // 2
    site.faults[ready.name] = lambda handler: handler.serve(ready.content, stop_after=half)
    fetch_base(ready.minor, site.url, home=tmp_path)
    first, second = [wanted for _, wanted in site.requests][:2]
    assert first is None
    assert 0 < resumed_at(second) <= half


def test_one_process_at_a_time_downloads(
    ready: Ready, site: Site, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "cache" / "bases"
    folder.mkdir(parents=True)
    words = [sys.executable, "-m", "kb_build.ready", ready.minor, "--from", site.url, "--home", str(tmp_path)]
    with locked(folder):
        with pytest.raises(FetchedElsewhere, match="another SimWorlds is fetching one here"):
            fetch_base(ready.minor, site.url, home=tmp_path)
        assert subprocess.run(words, cwd=REPO, capture_output=True, check=False).returncode == 3
    assert site.requests == []
    assert fetch_base(ready.minor, site.url, home=tmp_path).path.is_file()


def test_the_next_call_goes_on_where_the_last_one_ended(ready: Ready, site: Site, tmp_path: Path) -> None:
    half = len(ready.content) // 2

    def half_once(handler: Handler) -> None:
        site.faults[ready.name] = lambda later: later.send_error(503)
        handler.serve(ready.content, stop_after=half)

    site.faults[ready.name] = half_once
    with pytest.raises(ReadyBaseError, match="503"):
        fetch_base(ready.minor, site.url, home=tmp_path)
    site.faults.clear()
    site.requests.clear()
    fetch_base(ready.minor, site.url, home=tmp_path)
    assert [0 < resumed_at(wanted) <= half for _, wanted in site.requests] == [True]


def test_a_file_that_is_cut_off_is_refused(ready: Ready, tmp_path: Path) -> None:
    assert "given.tar.xz" in refused(tmp_path, ready.content[:-9], ready.minor)


def test_a_byte_that_differs_is_refused_wherever_it_is(ready: Ready, tmp_path: Path) -> None:
    length = len(ready.content)
    places = [
        0,
        7,
        10,
        40,
        length // 3,
        length // 2,
        length - 40,
        length - 20,
        length - 11,
        length - 5,
        length - 1,
    ]
    for place in places:
        changed = bytearray(ready.content)
        changed[place] ^= 0x10
        assert refused(tmp_path, bytes(changed), ready.minor), place


def test_a_byte_that_differs_on_the_way_leaves_the_base_that_was_there(
    source_base: Path, ready: Ready, site: Site, tmp_path: Path
) -> None:
    (tmp_path / "kb").mkdir()
    target = tmp_path / "kb" / source_base.name
    shutil.copyfile(source_base, target)
    before = target.read_bytes()
    changed = bytearray(ready.content)
    changed[len(changed) // 2] ^= 1
    site.files[ready.name] = bytes(changed)
    with pytest.raises(ReadyBaseError):
        fetch_base(ready.minor, site.url, home=tmp_path)
    assert target.read_bytes() == before


def test_a_checksum_behind_the_address_pins_the_file(ready: Ready, site: Site, tmp_path: Path) -> None:
    with pytest.raises(ReadyBaseError, match="another file"):
        fetch_base(ready.minor, f"{site.url}{ready.name}#sha256={'0' * 64}", home=tmp_path)
    fetch_base(ready.minor, f"{site.url}{ready.name}#sha256={ready.exported.sha256}", home=tmp_path)


@pytest.mark.parametrize(
    "source",
    [
        "http://192.0.2.1/bases",
        "ftp://127.0.0.1/x.tar.xz",
        "/nowhere/x.tar.xz",
        "https://[::1",
        f"https://[::1#sha256={'0' * 64}",
    ],
)
def test_a_place_that_cannot_be_trusted_or_read_is_refused(tmp_path: Path, source: str) -> None:
    with pytest.raises(ReadyBaseError):
        fetch_base("5.1", source, home=tmp_path)


def test_a_fragment_that_is_no_checksum_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadyBaseError, match="checksum"):
        fetch_base("5.1", "https://127.0.0.1/x.tar.xz#md5=1", home=tmp_path)


# Hostile files


@pytest.mark.parametrize(
    "name", ["../outside.sqlite", "/outside.sqlite", "kb\\..\\..\\outside.sqlite", "C:outside"]
)
def test_a_name_that_leads_out_is_refused(ready: Ready, tmp_path: Path, name: str) -> None:
    content = packed({**unpacked(ready.content), name: b"x"})
    assert "leads out" in refused(tmp_path, content, ready.minor)
    assert not list(tmp_path.rglob("outside*"))


def test_a_link_in_place_of_the_base_is_not_followed(ready: Ready, tmp_path: Path) -> None:
    members = unpacked(ready.content)
    link = tarfile.TarInfo("base.sqlite")
    link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
    del members["base.sqlite"]
    assert "has no base.sqlite" in refused(tmp_path, packed(members, link), ready.minor)


def test_a_bomb_is_refused_before_it_fills_the_disk(ready: Ready, tmp_path: Path) -> None:
    bomb = packed({**unpacked(ready.content), "base.sqlite": bytes(64 << 20)})
    assert len(bomb) < 1 << 20
    assert "bombs" in refused(tmp_path, bomb, ready.minor)


def test_another_member_is_refused(ready: Ready, tmp_path: Path) -> None:
    content = packed({**unpacked(ready.content), "startup.py": b"print()"})
    assert "startup.py" in refused(tmp_path, content, ready.minor)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema_version": 99}, "update SimWorlds"),
        ({"format": "other/1"}, "format"),
        ({"blender": "../../5.1"}, "blender"),
        ({"size": 1}, "1 and"),
        ({"sha256": "0" * 64}, "manifest says"),
        ({"licences": []}, "licences"),
        ({"blender": "5.0.1"}, "5.0.1"),
        ({"more": 1}, "more"),
    ],
)
def test_a_manifest_that_is_wrong_is_refused(
    ready: Ready, tmp_path: Path, change: dict[str, object], said: str
) -> None:
    assert said in refused(tmp_path, packed(described(unpacked(ready.content), **change)), ready.minor)


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE VIEW more AS SELECT 1",
        "CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM meta; END",
        "DROP TABLE links",
        "CREATE TABLE more (x)",
        "PRAGMA user_version=1",
        "PRAGMA application_id=1",
        "DELETE FROM symbols",
        "UPDATE meta SET value='5.1.9' WHERE name='blender'",
    ],
)
def test_a_base_of_another_layout_or_content_is_refused(ready: Ready, tmp_path: Path, statement: str) -> None:
    assert refused(tmp_path, changed_base(ready.content, tmp_path, statement), ready.minor)


def test_a_true_copy_that_was_packed_by_hand_is_taken(ready: Ready, tmp_path: Path) -> None:
    """What is refused above is refused for what was changed, not for how it was packed."""
    path = tmp_path / "copy.tar.xz"
    path.write_bytes(packed(unpacked(ready.content)))
    assert fetch_base(ready.minor, str(path), home=tmp_path / "home").path.is_file()


def test_a_page_in_place_of_a_base_is_refused(ready: Ready, site: Site, tmp_path: Path) -> None:
    site.files[ready.name] = b"<html>Please log in to this network</html>"
    with pytest.raises(ReadyBaseError, match="is not a ready base"):
        fetch_base(ready.minor, site.url, home=tmp_path)
