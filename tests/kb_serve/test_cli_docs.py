"""``simworlds docs`` and ``simworlds serve`` as commands."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
from dataclasses import asdict
from typing import TYPE_CHECKING

import pytest
from running import COMMAND, REPO, environment, run_here

from kb_build.pages.page import page_from_json
from kb_build.symbols.records import symbol_from_json
from kb_serve.in_use import other_in_use
from kb_serve.knowledge_base import KnowledgeBase
from simworlds.settings import version_of_base

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

QUALITY = "bpy.types.ClothSettings.quality"


def run(home: Path, *words: str, given: str = "", folder: Path = REPO) -> subprocess.CompletedProcess[str]:
    done = run_here(words, environment(home), folder, given.encode())
    return subprocess.CompletedProcess(
        done.args, done.returncode, done.stdout.decode("utf-8"), done.stderr.decode("utf-8")
    )


def run_in_a_process(home: Path, *words: str | bytes) -> subprocess.CompletedProcess[str]:
    command: list[str | bytes] = [*COMMAND, *words]
    return subprocess.run(
        command,
        env=environment(home),
        cwd=REPO,
        capture_output=True,
        encoding="utf-8",
        check=False,
        timeout=60,
    )


@pytest.fixture
def home(base: Path) -> Path:
    return base.parent.parent


@pytest.fixture
def expected(base: Path) -> Callable[..., dict[str, object]]:
    def answer(query: str, **more: int) -> dict[str, object]:
        with KnowledgeBase(base) as direct:
            return json.loads(json.dumps(asdict(direct.query(query, **more))))

    return answer


def test_the_answer_is_printed_as_markdown(home: Path, expected: Callable[..., dict[str, object]]) -> None:
    done = run_in_a_process(home, "docs", "ClothSettings.quality")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{expected('ClothSettings.quality')['text']}\n"


def test_words_need_no_quotes(home: Path, expected: Callable[..., dict[str, object]]) -> None:
    done = run(home, "docs", "--max-tokens", "400", "--limit", "3", "rigid", "body", "mass")
    answer = expected("rigid body mass", limit=3, max_tokens=400)
    assert done.stdout.rstrip().partition(" Next: ")[0] == str(answer["text"]).partition(" Next: ")[0]


@pytest.mark.parametrize("query", ["bpy.types.Object", 'obj.modifiers["GeometryNodes"]["Input_2"] = 5.0'])
def test_the_next_call_can_be_typed_as_it_stands(home: Path, query: str) -> None:
    first = run(home, "docs", query, "--max-tokens", "200").stdout
    _, mark, call = first.rstrip("_\n`").partition(" Next: `")
    assert mark
    words = shlex.split(call)
    assert words[1:3] == ["docs", query]
    following = run(home, *words[1:])
    assert following.returncode == 0
    assert following.stdout not in first


def test_json_is_the_answer_and_its_version(
    home: Path, base: Path, expected: Callable[..., dict[str, object]]
) -> None:
    done = run(home, "docs", "bpy.types.Object", "--json", "--max-tokens", "300", "--part", "2")
    assert (done.returncode, done.stderr) == (0, "")
    with KnowledgeBase(base) as direct:
        version = direct.meta["blender"]
    answer = expected("bpy.types.Object", max_tokens=300, part=2)
    assert json.loads(done.stdout) == {**answer, "blender": version}


def test_a_query_is_read_from_standard_input(home: Path, expected: Callable[..., dict[str, object]]) -> None:
    traceback = (
        "Traceback (most recent call last):\nAttributeError: 'Action' object has no attribute 'fcurves'\n"
    )
    done = run(home, "docs", "-", "--json", given=traceback)
    answer = json.loads(done.stdout)
    assert answer.pop("blender")
    assert answer == expected(traceback)
    long = run(home, "docs", "-", given="x" * 20_001)
    assert (long.returncode, long.stdout) == (2, "")
    assert "more than the limit of 20,000" in long.stderr


@pytest.mark.parametrize(
    "words",
    [("docs", QUALITY), ("check", "script.py"), ("migrate", "script.py"), ("stubs", "--out", "out")],
)
def test_a_base_of_another_blender_than_the_one_in_use_is_told(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    monkeypatch.setattr("kb_serve.in_use.installed_bpy", lambda: "98.1.2")
    (tmp_path / "script.py").write_text("import bpy\n")
    done = run(home, *words, folder=tmp_path)
    assert done.returncode == 0
    said = done.stdout if words[0] == "docs" else done.stderr
    assert "knowledge base, but Blender 98.1.2 is in use. Build its base: " in said
    assert "kb build 98.1" in said
    assert run(home, "docs", "qqqzzzxxqv").returncode == 1


def test_a_version_that_is_named_is_the_one_that_is_wanted(
    home: Path, base: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kb_serve.in_use.installed_bpy", lambda: "98.1.2")
    done = run(home, "docs", QUALITY, "--blender", version_of_base(base))
    assert "98.1.2" not in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("have", "in_use", "is_told"),
    [
        ("4.2.23", "5.1.2", True),
        ("5.1.2", "4.2.23", True),
        ("5.1.1", "5.1.2", True),
        ("5.1.2", "5.1.1", False),
        ("5.1.2", "5.1.2", False),
        ("5.1.2", None, False),
        ("", "5.1.2", False),
    ],
)
def test_another_minor_version_and_a_newer_blender_are_told(
    have: str, in_use: str | None, is_told: bool
) -> None:
    assert bool(other_in_use(have, in_use)) is is_told


def test_raw_is_the_whole_record_of_a_symbol(home: Path, base: Path) -> None:
    done = run(home, "docs", "--raw", "ClothSettings.quality")
    assert done.returncode == 0
    with KnowledgeBase(base) as direct:
        assert symbol_from_json(json.loads(done.stdout)) == direct.symbol(QUALITY)


def test_raw_is_the_whole_record_of_a_page(home: Path, base: Path) -> None:
    done = run(home, "docs", "--raw", "physics/cloth/introduction")
    assert done.returncode == 0
    with KnowledgeBase(base) as direct:
        assert page_from_json(json.loads(done.stdout)) == direct.page("physics/cloth/introduction")


@pytest.mark.parametrize("way", [(), ("--json",), ("--raw",)])
def test_nothing_found_is_exit_code_1(home: Path, way: tuple[str, ...]) -> None:
    done = run(home, "docs", "qqqzzzxxqv", *way)
    assert done.returncode == 1
    assert done.stdout or done.stderr


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("",), "empty"),
        ((QUALITY, "--limit", "0"), "'--limit': 0 is not in the range x>=1"),
        ((QUALITY, "--part", "0"), "'--part': 0 is not in the range x>=1"),
        ((QUALITY, "--part", "99"), "part"),
        ((QUALITY, "--max-tokens", "1"), "1 is not in the range x>=150"),
        ((QUALITY, "--max-tokens", "many"), "--max-tokens"),
        ((QUALITY, "--blender", "9.9"), "simworlds kb build 9.9"),
        ((QUALITY, "--blender", "../../etc"), "not a Blender version"),
        ((QUALITY, "--json", "--raw"), "--raw"),
        ((), "QUERY"),
        (("--no-such-option", QUALITY), "--no-such-option"),
    ],
)
def test_errors_are_exit_code_2_and_say_why(home: Path, words: tuple[str, ...], hint: str) -> None:
    done = run(home, "docs", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert hint in done.stderr


def test_without_a_base_it_says_what_to_do(tmp_path: Path) -> None:
    done = run(tmp_path, "docs", QUALITY)
    assert (done.returncode, done.stdout) == (2, "")
    assert "simworlds kb build" in done.stderr


def test_a_damaged_base_is_named(tmp_path: Path) -> None:
    (tmp_path / "kb").mkdir()
    (tmp_path / "kb" / "blender-5.1.sqlite").write_bytes(b"no base")
    done = run(tmp_path, "docs", QUALITY)
    assert (done.returncode, done.stdout) == (2, "")
    assert "blender-5.1.sqlite" in done.stderr
    assert "simworlds kb build" in done.stderr


@pytest.mark.parametrize(
    "query", ["🙂", "x" * 10_000, '"', "NEAR(a b)", "name:*", "-- -x", "../../etc/passwd"]
)
def test_any_text_is_answered_or_refused_in_words(home: Path, query: str) -> None:
    done = run(home, "docs", "--", query)
    assert done.returncode in {0, 1}


@pytest.mark.skipif(os.name == "nt", reason="arguments are bytes on POSIX only")
def test_bytes_that_are_no_text_are_no_crash(home: Path) -> None:
    done = run_in_a_process(home, "docs", b"cloth \xff\xfe")
    assert done.returncode in {0, 1}
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="pseudo-terminals are POSIX's")
def test_on_a_terminal_the_markdown_is_rendered(home: Path) -> None:
    import pty

    leader, follower = pty.openpty()
    with subprocess.Popen(
        [*COMMAND, "docs", QUALITY],
        stdin=follower,
        stdout=follower,
        stderr=follower,
        env=environment(home, TERM="xterm", COLUMNS="80"),
        cwd=REPO,
    ) as process:
        os.close(follower)
        shown = b""
        try:
            while more := os.read(leader, 4096):
                shown += more
        except OSError:  # how Linux says that the other side has gone
            pass
        os.close(leader)
    assert process.returncode == 0
    assert b"Quality" in shown
    assert b"## " not in shown
    assert b"\x1b[" in shown


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--port", "1234"), "go with --http"),
        (("--token", "secret"), "go with --http"),
        (("--blender", "five"), "'five' is not a Blender version"),
        (("--blender-exe", "/nowhere"), "no Blender executable at /nowhere"),
        (("--http", "--blender-exe", "/bin/true"), "/bin/true is not Blender"),
        (("--http", "--port", "0", "--allow-host", "https://docs.example.org/x"), "is not a host name"),
        (("--http", "--port", "0", "--allow-host", ""), "--allow-host '' is not a host name"),
    ],
)
def test_a_server_that_cannot_work_as_it_is_told_does_not_start(
    home: Path, options: tuple[str, ...], why: str
) -> None:
    done = run(home, "serve", *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert why in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="pseudo-terminals are POSIX's")
def test_a_server_on_a_terminal_says_what_it_waits_for(home: Path) -> None:
    import pty

    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [*COMMAND, "serve"],
        env=environment(home),
        stdin=theirs,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        os.close(theirs)
        assert process.stderr is not None
        assert "Waiting for an MCP client on standard input" in process.stderr.readline()
        os.close(ours)
        process.terminate()
