"""What is fuzzed: what reads the work of others. Each either takes its bytes or refuses them in words."""

from __future__ import annotations

import io
import json
import lzma
import os
import select
import struct
import sys
import tarfile
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from broken_input import LONGEST, broken
from hypothesis import strategies as st

from agents.blender.inside.blend.stored_texts import UnknownForm, replace_texts
from agents.loop.errors import NoRun
from agents.loop.record import events
from agents.loop.record.journal import NAME, read_rows
from agents.loop.record.reducer import read_run_state
from agents.plan.check import read_plan
from agents.protocol.verify_request import plan_from
from kb_build.errors import KBBuildError, SourceError
from kb_build.pages.archives import ArchiveLimits, unpack
from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from kb_build.pages.readers.workers import PageBudget
from kb_build.ready.fetch import fetch_base
from kb_build.ready.manifest import LICENCES, Manifest
from kb_build.schema import SCHEMA_VERSION
from kb_serve.errors import KBServeError
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.service import readable

if TYPE_CHECKING:
    from collections.abc import Callable

    Check = Callable[[bytes], None]

REPO = Path(__file__).resolve().parents[2]
_BUDGET = PageBudget(cpu_seconds=5, memory=512 << 20)
_SMALL = ArchiveLimits(total_bytes=8 << 20, members=200, ratio=100, free_bytes=1 << 20)
_ANSWER_SECONDS = 60.0


@dataclass(frozen=True)
class Target:
    """What is given to a reader, and the check of one of these: it raises what must not be."""

    name: str
    given: st.SearchStrategy[bytes]
    check: Check


# Queries and messages


class Queries:
    """The knowledge base's answers."""

    def __init__(self, base: Path) -> None:
        self._base = KnowledgeBase(base)

    def close(self) -> None:
        """Closes the base."""
        self._base.close()

    def check(self, data: bytes) -> None:
        """Whatever is asked is answered within its budget, or refused."""
        try:
            answer = self._base.query(
                readable(data.decode(errors="surrogateescape")[:20_000]), max_tokens=400
            )
        except KBServeError:
            return
        assert answer.kind in {"schema", "page", "candidates", "none"}


QUERIES = (
    b'bpy.context.object.modifiers["Cloth"].settings.quality',
    b"AttributeError: 'Object' object has no attribute 'draw_type'",
    b"make cloth collide with itself",
    b'mat.node_tree.nodes["Principled BSDF"].inputs["Specular"].default_value = 1',
    b"TypeError: bpy_struct: item.attr = val: enum \"EEVEE\" not found in ('CYCLES')",
    b"https://docs.blender.org/api/current/bpy.types.Object.html#bpy.types.Object.location",
    "RigdBodyObject.colision_shape é🎨".encode(),
)


class Messages:
    """A server's stdin: after any line it still answers."""

    def __init__(self, home: Path) -> None:
        import subprocess

        self._number = 0
        self._pending = b""
        words = [sys.executable, "-m", "simworlds", "serve", "--no-rebuild"]
        environment = {**os.environ, "SIMWORLDS_HOME": str(home), "PYTHONPATH": str(REPO)}
        self._process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment
        )
        self._send(json.dumps(HANDSHAKE).encode())
        self._until(0)

    def close(self) -> None:
        """Ends the server."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.kill()
        self._process.wait()

    def check(self, data: bytes) -> None:
        """The line is followed by a ping, which is answered."""
        self._send(data.replace(b"\n", b" "))
        self._number += 1
        self._send(json.dumps({"jsonrpc": "2.0", "id": f"p{self._number}", "method": "ping"}).encode())
        self._until(f"p{self._number}")

    def _send(self, line: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(line + b"\n")
        self._process.stdin.flush()

    def _until(self, number: object) -> None:
        assert self._process.stdout is not None
        descriptor = self._process.stdout.fileno()
        while True:
            line, found, rest = self._pending.partition(b"\n")
            if found:
                self._pending = rest
                message: Any = json.loads(line)
                if message.get("id") == number:
                    return
                continue
            ready, _, _ = select.select([descriptor], [], [], _ANSWER_SECONDS)
            assert ready, "the server does not answer any more"
            data = os.read(descriptor, 1 << 16)
            assert data, "the server has ended"
            self._pending += data


HANDSHAKE = {
    "jsonrpc": "2.0",
    "id": 0,
    "method": "initialize",
    "params": {
        "protocolVersion": "2025-06-18",
        "capabilities": {},
        "clientInfo": {"name": "fuzz", "version": "1"},
    },
}
MESSAGES = tuple(
    json.dumps({"jsonrpc": "2.0", **message}).encode()
    for message in (
        {"id": 1, "method": "tools/list"},
        {
            "id": 2,
            "method": "tools/call",
            "params": {"name": "blender_docs", "arguments": {"query": "cloth", "limit": 2}},
        },
        {
            "id": 3,
            "method": "tools/call",
            "params": {"name": "blender_check", "arguments": {"code": "import bpy\nbpy.x"}},
        },
        {"id": 4, "method": "resources/read", "params": {"uri": "blender://5.1/symbol/bpy.types.Object"}},
        {"method": "notifications/cancelled", "params": {"requestId": 2}},
        {"id": [5], "method": "ping"},
    )
)


# Archives and bases


def archive(data: bytes) -> None:
    """Nothing is written outside of the folder, and nothing at all by what is refused."""
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        (top / "archive").write_bytes(data)
        try:
            unpack(top / "archive", top / "target", limits=_SMALL)
        except SourceError:
            assert not (top / "target").exists()
        assert {path.name for path in top.iterdir()} <= {"archive", "target"}
        assert not [path for path in (top / "target").rglob("*") if path.is_symlink()]


def _archives() -> list[bytes]:
    made: list[bytes] = []
    link = tarfile.TarInfo("link")
    link.type, link.linkname = tarfile.SYMTYPE, "../.."
    for mode in ("w", "w:gz", "w:xz", "w:bz2"):
        data = io.BytesIO()
        with tarfile.open(fileobj=data, mode=mode) as file:  # type: ignore[call-overload]
            for name, text in (("a/index.rst", b"Title\n=====\n"), ("b.txt", b"x" * 700)):
                member = tarfile.TarInfo(name)
                member.size = len(text)
                file.addfile(member, io.BytesIO(text))
            file.addfile(link)
        made.append(data.getvalue())
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("a/index.html", "<title>Blender 5.1 Manual</title>")
        file.writestr("b.txt", "x" * 700)
    return [*made, data.getvalue()]


def ready_base(data: bytes) -> None:
    """Bytes in place of a manifest, before a base that is none: always refused, and nothing stays."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as file:
        for name, text in (("manifest.json", data), ("NOTICE.txt", b"-"), ("base.sqlite", data)):
            member = tarfile.TarInfo(name)
            member.size = len(text)
            file.addfile(member, io.BytesIO(text))
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        (top / "base.tar.xz").write_bytes(lzma.compress(packed.getvalue(), preset=0))
        try:
            fetch_base("5.1", str(top / "base.tar.xz"), home=top / "home")
        except KBBuildError:
            assert not [path for path in (top / "home").rglob("*") if path.is_file()]
        else:
            raise AssertionError("a base that is none was taken")


MANIFEST = Manifest(
    blender="5.1.2",
    schema_version=SCHEMA_VERSION,
    size=5,
    sha256="0" * 64,
    built_at="2026-01-01T00:00:00+00:00",
    simworlds="0.1.0",
    licences=LICENCES,
)


# Pages


def rst(data: bytes) -> None:
    """The page beside it is read as it is."""
    _page_beside(data, ".rst", "Kind\n====\n\nText.\n")


def html(data: bytes) -> None:
    """The page beside it is read as it is."""
    _page_beside(data, ".html", "<html><main><h1>Kind</h1><p>Text.</p></main></html>")


def _page_beside(data: bytes, suffix: str, kind: str) -> None:
    read = read_rst if suffix == ".rst" else read_html
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / f"page{suffix}").write_bytes(data)
        (folder / f"index{suffix}").write_text(kind)
        pages = {page.slug: page for page in read(folder, source="manual", version="5.1", budget=_BUDGET)}
    assert pages.keys() == {"index", "page"}
    assert "Text." in pages["index"].sections[0].text


RST = (
    b"Title\n=====\n\n.. note:: A note.\n\n   - item\n\n.. figure:: /a.png\n\n   Caption :ref:`x <y>`.\n",
    b".. list-table::\n   :widths: 1 2\n\n   * - a\n     - b\n\n|sub| ``code`` [1]_\n\n.. |sub| replace:: x\n",
    b".. toctree::\n   :glob:\n\n   *\n\n.. _a: b_\n.. _b: a_\n\n+--+--+\n|a | b|\n+--+--+\n",
)
RST_WORDS = (
    b".. include:: /etc/hostname\n",
    b":doc:`/../x`",
    b"|",
    b"``",
    b".. raw:: html\n\n   ",
    b"   ",
    b"\n\n",
    b"::",
)
HTML = (
    b"<html><main><h1 id=a>T</h1><table><tr><td colspan=3>x</td></tr></table><dl><dt>a<dd>b</dl></main></html>",
    b'<div class="section" id="x"><h2>H</h2><pre>code</pre><ul><li><p>a</p></ul><img alt="y" src="z.png"></div>',
)
HTML_WORDS = (
    b"<td rowspan=99999>",
    b"<![CDATA[",
    b"</p>",
    b"<!--",
    b"<svg>",
    b"&#x110000;",
    b"<b>" * 200,
    b"<dl><dt>",
)


# .blend files


def blend(data: bytes) -> None:
    """Where the form is not known, nothing is changed."""
    with tempfile.NamedTemporaryFile(suffix=".blend") as file:
        file.write(data)
        file.flush()
        try:
            replace_texts(file.name, "Object", "name", {"old": "new"})
        except UnknownForm:
            assert Path(file.name).read_bytes() == data
        else:
            assert Path(file.name).stat().st_size == len(data)


def small_blend(*, new_head: bool) -> bytes:
    """The least .blend with two structs: an Object with a name, and its DNA."""
    names, types = (b"name[16]", b"*next"), (b"char", b"Object")
    dna = b"SDNA" + b"NAME" + struct.pack("<i", len(names)) + b"".join(name + b"\0" for name in names)
    dna = dna.ljust((len(dna) + 3) // 4 * 4, b"\0")
    dna += b"TYPE" + struct.pack("<i", len(types)) + b"".join(name + b"\0" for name in types)
    dna = dna.ljust((len(dna) + 3) // 4 * 4, b"\0")
    dna += b"TLEN" + struct.pack("<2H", 1, 24) + b"STRC" + struct.pack("<i", 1)
    dna += struct.pack("<2H", 1, 2) + struct.pack("<4H", 1, 1, 0, 0)
    content = bytes(8) + b"old".ljust(16, b"\0")
    blocks = ((b"OB\0\0", content, 0, 1), (b"DNA1", dna, 0, 1), (b"ENDB", b"", 0, 0))
    if new_head:
        return b"BLENDER17-01v0501" + b"".join(
            struct.pack("<4siQqq", code, kind, 0, len(text), count) + text
            for code, text, kind, count in blocks
        )
    return b"BLENDER-v405" + b"".join(
        struct.pack("<4siQii", code, len(text), 0, kind, count) + text for code, text, kind, count in blocks
    )


# Journals and plans


def journal(data: bytes) -> None:
    """A journal is read to the run's state, or is none."""
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / NAME).write_bytes(data)
        try:
            rows = read_rows(Path(name) / NAME)
        except NoRun:
            return
        state = read_run_state(Path(name))
    assert state is not None
    assert all(isinstance(row["type"], str) for row in rows)


def plan(data: bytes) -> None:
    """A plan is taken, or its faults are named."""
    read, faults = read_plan(data)
    assert (read is None) == bool(faults)
    plan_from(data)


def _subclasses(of: type[events.Event]) -> list[type[events.Event]]:
    return [of, *(deeper for one in of.__subclasses__() for deeper in _subclasses(one))]


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-2, 1 << 60)
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(
        [
            "modeling",
            "light",
            "closed",
            "failed",
            "coder",
            "blender_execute",
            "2026-11-20T10:00:00+00:00",
            "../../x",
        ]
    ),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)


@st.composite
def journals(draw: st.DrawFn) -> bytes:
    """Rows of the types that there are, with any values in their fields."""
    rows: list[bytes] = []
    for kind in draw(st.lists(st.sampled_from(_subclasses(events.Event)), max_size=10)):
        names = [field.alias or name for name, field in kind.model_fields.items() if name != "type"]
        row: dict[str, Any] = {name: draw(VALUES) for name in names if draw(st.booleans())}
        row["type"] = kind.model_fields["type"].default if "type" in kind.model_fields else "x"
        rows.append(json.dumps(row).encode() + b"\n")
    return b"".join(rows)


def targets(queries: Queries | None, plans: list[bytes], messages: Messages) -> list[Target]:
    """All of them; without a base, all but queries."""
    found = [
        Target("archive", broken(_archives(), [b"../", b"/", b"\\", b"PK\x05\x06", b"ustar"]), archive),
        Target(
            "ready_base", broken([MANIFEST.model_dump_json().encode()], [b"null", b"[", b'"']), ready_base
        ),
        Target("rst", broken(RST, RST_WORDS), rst),
        Target("html", broken(HTML, HTML_WORDS), html),
        Target(
            "blend",
            broken([small_blend(new_head=True), small_blend(new_head=False)], [b"DNA1", b"ENDB"]),
            blend,
        ),
        Target(
            "journal",
            journals() | broken([b'{"type": "run.began", "prompt": "x"}\n'], [b"{", b"[" * 900]),
            journal,
        ),
        Target("plan", broken(plans, [b"null", b"NaN", b"[" * 900, b"{}", b'"', b"1e400"]), plan),
    ]
    if queries is not None:
        found.append(
            Target("query", broken(QUERIES, [b".", b"[", b'"', b"(" * 60, b"a." * 300]), queries.check)
        )
    words = [b"{}", b"null", b'"id"', b"[" * 900, b"\xff"]
    found.append(Target("message", broken(MESSAGES, words), messages.check))
    assert all(len(data) <= LONGEST for data in plans)
    return found
