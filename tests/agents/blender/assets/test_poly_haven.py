"""Poly Haven's API, answered by a server of our own in the same shape: what is fetched, checked, and refused."""

from __future__ import annotations

import hashlib
import json
import re
import threading
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner

from agents.blender.assets import poly_haven
from agents.blender.assets.library import open_library
from agents.blender.assets.licence import NOTE_FILE, LicenceNote
from agents.blender.assets.map_names import texture_sets
from agents.blender.assets.poly_haven import PolyHaven
from agents.blender.blender_sessions import BlenderSessions, SessionSetup
from agents.commands.mcp import mcp
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator

TEXTURE = {
    "name": "Brick Floor 003",
    "type": 1,
    "date_published": 1618385199,
    "authors": {"Dimitrios Savva": "Photography", "Rob Tuytel": "Processing"},
    "categories": ["floor", "brick"],
    "tags": ["red", "pavement"],
    "max_resolution": [8192, 8192],
}
HDRI = {
    "name": "Kiara Dawn",
    "type": 0,
    "authors": {"Greg Zaal": "All"},
    "categories": ["outdoor"],
    "tags": ["sunrise"],
}
MODEL = {
    "name": "Horse Statue 01",
    "type": 2,
    "authors": {"Rico Cilliers": "All"},
    "categories": [],
    "tags": [],
}


class Haven(ThreadingHTTPServer):
    """The server. ``contents``: files by name; ``cut``: bytes after which the next transfers of a file break off."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Answers)
        self.origin = f"http://127.0.0.1:{self.server_address[1]}"
        self.contents: dict[str, bytes] = {}
        self.cut: dict[str, list[int]] = {}
        self.asked: list[tuple[str, str, str]] = []
        self.info: dict[str, Any] = {
            "brick_floor_003": TEXTURE,
            "kiara_1_dawn": HDRI,
            "horse_statue_01": MODEL,
        }
        self.files: dict[str, Any] = {
            "brick_floor_003": {
                "Diffuse": self._each("brick_floor_003_diff", "jpg", "png"),
                "nor_gl": self._each("brick_floor_003_nor_gl", "jpg", "exr"),
                "nor_dx": self._each("brick_floor_003_nor_dx", "jpg"),
                "Rough": self._each("brick_floor_003_rough", "jpg"),
                "AO": self._each("brick_floor_003_ao", "jpg"),
                "Displacement": self._each("brick_floor_003_disp", "png"),
                "arm": self._each("brick_floor_003_arm", "jpg"),
                "blend": {"1k": {"blend": self.file("brick_floor_003_1k.blend") | {"include": {}}}},
            },
            "kiara_1_dawn": {
                "hdri": {
                    size: {"hdr": self.file(f"kiara_1_dawn_{size}.hdr", 300_000)} for size in ("1k", "2k")
                },
                "tonemapped": self.file("kiara_1_dawn.jpg"),
            },
            "horse_statue_01": {
                "gltf": {
                    "1k": {
                        "gltf": self.file("horse_statue_01_1k.gltf")
                        | {
                            "include": {
                                "textures/horse_diff_1k.jpg": self.file("horse_diff_1k.jpg"),
                                "horse_statue_01.bin": self.file("horse_statue_01.bin"),
                            }
                        }
                    }
                }
            },
        }

    def _each(self, name: str, *endings: str) -> dict[str, Any]:
        return {
            size: {ending: self.file(f"{name}_{size}.{ending}") for ending in endings}
            for size in ("1k", "2k")
        }

    def file(self, name: str, size: int = 2000) -> dict[str, Any]:
        """The entry of a file, which is there from now on."""
        content = (name.encode() * (1 + size // len(name)))[:size]
        self.contents[name] = content
        return {
            "url": f"{self.origin}/file/ph-assets/{name}",
            "md5": hashlib.md5(content, usedforsecurity=False).hexdigest(),
            "size": size,
        }


class Answers(BaseHTTPRequestHandler):
    """Answers as the API and its file host do."""

    server: Haven  # pyright: ignore[reportIncompatibleVariableOverride]

    def log_message(self, format: str, *args: Any) -> None:
        """Says nothing."""

    def do_GET(self) -> None:
        haven = self.server
        haven.asked.append((self.path, self.headers.get("User-Agent", ""), self.headers.get("Range", "")))
        kind, _, name = self.path[1:].partition("/")
        if self.path.startswith("/assets?type="):
            wanted = ["hdris", "textures", "models"].index(self.path.rpartition("=")[2])
            self._json({name: info for name, info in haven.info.items() if info["type"] == wanted})
        elif kind in {"info", "files"} and name in getattr(haven, kind):
            self._json(getattr(haven, kind)[name])
        elif kind == "file" and (content := haven.contents.get(name.rpartition("/")[2])) is not None:
            self._file(name.rpartition("/")[2], content)
        else:
            self.send_error(404)

    def _json(self, data: Any) -> None:
        body = data if isinstance(data, bytes) else json.dumps(data).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def _file(self, name: str, content: bytes) -> None:
        begin = int(self.headers["Range"][6:-1]) if "Range" in self.headers else 0
        self.send_response(206 if begin else 200)
        if begin:
            self.send_header("Content-Range", f"bytes {begin}-{len(content) - 1}/{len(content)}")
        self.send_header("Content-Length", str(len(content) - begin))
        self.end_headers()
        cuts = self.server.cut.get(name)
        end = cuts.pop(0) if cuts else len(content)
        self.wfile.write(content[begin:end])


@pytest.fixture
def haven() -> Iterator[Haven]:
    """A server, and nothing else, in Poly Haven's place."""
    with Haven() as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def online(haven: Haven) -> PolyHaven:
    return PolyHaven(haven.origin, frozenset({haven.origin}))


def test_searches_find_names_tags_and_categories(haven: Haven) -> None:
    source = online(haven)
    assert [name for name, _ in source.search("red brick", "textures")] == ["brick_floor_003"]
    assert [name for name, _ in source.search("sunrise", "hdris")] == ["kiara_1_dawn"]
    assert source.search("sunrise", "textures") == []
    assert [path for path, _, _ in haven.asked] == ["/assets?type=textures", "/assets?type=hdris"]
    assert {agent for _, agent, _ in haven.asked} == {"SimWorlds asset library"}


def test_new_assets_are_found_by_a_server_that_runs_for_long(haven: Haven) -> None:
    seconds = [0.0]
    source = PolyHaven(haven.origin, frozenset({haven.origin}), clock=lambda: seconds[0])
    assert source.search("floor", "textures")
    old = next(name for name, info in haven.info.items() if info["type"] == 1)
    haven.info = {**haven.info, "cobble_floor": {**haven.info[old], "name": "Cobble Floor"}}
    assert "cobble_floor" not in dict(source.search("floor", "textures"))
    seconds[0] = 3700.0
    assert "cobble_floor" in dict(source.search("floor", "textures"))


def test_a_texture_comes_with_all_its_maps_and_its_licence(haven: Haven, tmp_path: Path) -> None:
    fetched = online(haven).fetch("brick_floor_003", "1k", tmp_path)
    names = [path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()]
    ((_, maps),) = texture_sets(names).items()
    assert set(maps) == {
        "base_color",
        "normal",
        "roughness",
        "ambient_occlusion",
        "displacement",
        "occlusion_roughness_metallic",
    }
    assert (tmp_path / maps["base_color"]).read_bytes() == haven.contents["brick_floor_003_diff_1k.jpg"]
    assert fetched.main.startswith("brick_floor_003_diffuse")
    note = LicenceNote.model_validate_json((fetched.folder / NOTE_FILE).read_bytes())
    assert (note.license, note.author) == ("CC0", "Dimitrios Savva, Rob Tuytel")
    assert set(note.md5) == set(fetched.files)


def test_hdris_and_models_come_with_what_belongs_to_them(haven: Haven, tmp_path: Path) -> None:
    assert online(haven).fetch("kiara_1_dawn", "2k", tmp_path).files == ("kiara_1_dawn_2k.hdr",)
    model = online(haven).fetch("horse_statue_01", "1k", tmp_path)
    assert model.main == "horse_statue_01_1k.gltf"
    assert set(model.files) == {
        "horse_statue_01_1k.gltf",
        "textures/horse_diff_1k.jpg",
        "horse_statue_01.bin",
    }
    assert (model.folder / "textures" / "horse_diff_1k.jpg").is_file()


def test_what_was_fetched_is_not_fetched_again(haven: Haven, tmp_path: Path) -> None:
    online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    before = len(haven.asked)
    fetched = online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    assert not [path for path, _, _ in haven.asked[before:] if path.startswith("/file/")]
    (fetched.folder / fetched.main).write_bytes(b"damaged")
    online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    assert (fetched.folder / fetched.main).read_bytes() == haven.contents["kiara_1_dawn_1k.hdr"]


def test_a_transfer_that_breaks_off_goes_on_where_it_was(haven: Haven, tmp_path: Path) -> None:
    haven.cut["kiara_1_dawn_1k.hdr"] = [100_000, 200_000]
    told: list[tuple[float, float | None, str]] = []
    fetched = online(haven).fetch(
        "kiara_1_dawn", "1k", tmp_path, told=lambda done, total, text: told.append((done, total, text))
    )
    assert (fetched.folder / fetched.main).read_bytes() == haven.contents["kiara_1_dawn_1k.hdr"]
    ranges = [wanted for path, _, wanted in haven.asked if path.startswith("/file/")]
    assert ranges == ["", "bytes=100000-", "bytes=200000-"]
    assert told[-1][:2] == (300_000, 300_000)


def test_what_never_comes_whole_is_kept_for_the_next_call_and_is_no_asset(
    haven: Haven, tmp_path: Path
) -> None:
    haven.cut["kiara_1_dawn_1k.hdr"] = [50_000, 50_000]
    with pytest.raises(Refusal, match=r"broke off after 50,000 of 300,000 bytes .* Call again"):
        online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [".fetching"]
    haven.asked.clear()
    online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    assert [wanted for path, _, wanted in haven.asked if path.startswith("/file/")] == ["bytes=50000-"]


def test_a_cancelled_call_ends(haven: Haven, tmp_path: Path) -> None:
    cancelled = threading.Event()
    cancelled.set()
    with pytest.raises(Refusal, match="was cancelled"):
        online(haven).fetch("kiara_1_dawn", "1k", tmp_path, cancelled=cancelled)
    with pytest.raises(Refusal, match="took too long"):
        online(haven).fetch("kiara_1_dawn", "2k", tmp_path, timeout=0.0)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"md5": "0" * 32}, "its MD5 differs"),
        ({"size": 1000}, "is longer than the 1,000 bytes"),
        ({"size": 400_000}, "broke off after 300,000"),
        ({"size": 3 << 30}, "answer is not what it should be"),
        ({"md5": "../../x"}, "answer is not what it should be"),
        ({"url": "https://example.org/kiara_1_dawn_1k.hdr"}, "which is not where its files are"),
        ({"url": "file:///etc/passwd"}, "which is not where its files are"),
    ],
)
def test_files_that_are_not_as_listed_are_refused(
    haven: Haven, tmp_path: Path, change: dict[str, Any], why: str
) -> None:
    haven.files["kiara_1_dawn"]["hdri"]["1k"]["hdr"] |= change
    with pytest.raises(Refusal, match=why):
        online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    assert not list(tmp_path.rglob("*.hdr"))


@pytest.mark.parametrize("place", ["../escaped.bin", "/etc/escaped.bin", "a/../../escaped.bin", "..", "a\0b"])
def test_included_files_stay_in_their_folder(haven: Haven, tmp_path: Path, place: str) -> None:
    entry = haven.files["horse_statue_01"]["gltf"]["1k"]["gltf"]
    entry["include"][place] = entry["include"]["horse_statue_01.bin"]
    with pytest.raises(Refusal, match="may not be written; nothing was fetched"):
        online(haven).fetch("horse_statue_01", "1k", tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "resolution", "why"),
    [
        ("nothing_like_it", "1k", "Poly Haven has no 'nothing_like_it'"),
        ("../info", "1k", "is not an id of Poly Haven"),
        ("kiara_1_dawn", "8k", "has no hdri 8k hdr; it has 1k, 2k"),
        ("brick_floor_003", "8k", "has no maps in 8k"),
    ],
)
def test_what_is_not_there_is_told(
    haven: Haven, tmp_path: Path, name: str, resolution: Any, why: str
) -> None:
    with pytest.raises(Refusal, match=why):
        online(haven).fetch(name, resolution, tmp_path)


def test_malformed_answers_and_silent_hosts_are_told(haven: Haven, tmp_path: Path) -> None:
    haven.info["kiara_1_dawn"] = {"name": "x" * 1000, "type": 0}
    with pytest.raises(Refusal, match="not what it should be"):
        online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    haven.info["kiara_1_dawn"] = b"[1, 2"
    with pytest.raises(Refusal, match="not what it should be"):
        online(haven).fetch("kiara_1_dawn", "1k", tmp_path)
    nobody = PolyHaven("http://127.0.0.1:9", frozenset())
    with pytest.raises(Refusal, match="cannot be reached"):
        nobody.search("brick", "textures")


def test_no_other_address_is_in_the_code() -> None:
    text = Path(poly_haven.__file__).read_text(encoding="utf-8")
    hosts = set(re.findall(r"https?://([\w.-]+)", text))
    assert hosts == {"api.polyhaven.com", "dl.polyhaven.org", "polyhaven.com"}


def test_a_server_asks_nobody_without_the_option(tmp_path: Path) -> None:
    given = SessionSetup(best_sandbox(), assets=tmp_path)
    plain, online = BlenderSessions(given), BlenderSessions(replace(given, online=True))
    assert plain.has_assets
    assert not plain.is_online
    assert online.is_online
    assert open_library(tmp_path).online is None
    called = CliRunner().invoke(mcp, ["--online"])
    assert called.exit_code == 2
    assert "--online needs --assets" in called.output
