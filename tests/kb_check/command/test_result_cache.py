"""Results that are kept between runs."""

from __future__ import annotations

import multiprocessing
import sys
from pathlib import Path

import pytest
from places import REPO

from kb_check.command import cache as cache_module
from kb_check.command.cache import ResultCache, result_key
from kb_check.findings import Edit, Finding, Fix, Span

SPAN = Span(1, 2, 3, 4)
FULL = Finding(
    "a",
    "warning",
    SPAN,
    "é\ud800",
    "s",
    ("i", "j"),
    Fix("t", (Edit(SPAN, "x"), Edit(SPAN, "")), sure=True),
    ("k",),
)
PLAIN = Finding("b", "error", SPAN, "wrong")


def test_what_was_put_is_found_again_by_another(tmp_path: Path) -> None:
    path = tmp_path / "new" / "cache.sqlite"
    with ResultCache(path) as cache:
        cache.put(b"k", [[FULL], [], [PLAIN, FULL]])
    with ResultCache(path) as cache:
        assert cache.get(b"k") == [[FULL], [], [PLAIN, FULL]]
        assert cache.get(b"other") is None


def test_a_key_is_of_all_that_counts() -> None:
    file = ("a.py", b"x", True)
    others = [
        result_key("base", []), result_key("base", [file, file]), result_key("other", [file]),
        result_key("base", [("b.py", b"x", True)]), result_key("base", [("a.py", b"y", True)]),
        result_key("base", [("a.py", b"x", False)]), result_key("base", [("a", b".pyx", True)]),
    ]  # fmt: skip
    assert len({result_key("base", [file]), *others}) == 8


def test_a_key_is_of_all_code_that_findings_come_from(monkeypatch: pytest.MonkeyPatch) -> None:
    read: set[Path] = set()
    read_bytes = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read.add(path) or read_bytes(path))
    cache_module.code_digest.__wrapped__()
    assert {
        path
        for part in ("kb_check", "kb_build", "kb_serve", "simworlds")
        for path in (REPO / part).rglob("*.py")
    } == read


@pytest.mark.parametrize("version", ["3.11.9", "3.13.1"])
def test_a_key_is_of_the_python_that_parses(monkeypatch: pytest.MonkeyPatch, version: str) -> None:
    here = cache_module.code_digest()
    monkeypatch.setattr(sys, "version", version)
    assert cache_module.code_digest.__wrapped__() != here


@pytest.mark.parametrize("content", [b"this is no database" * 500, b"SQLite format 3\0" + b"x" * 5_000])
def test_a_broken_file_is_made_anew(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "cache.sqlite"
    path.write_bytes(content)
    with ResultCache(path) as cache:
        cache.put(b"k", [[PLAIN]])
    with ResultCache(path) as cache:
        assert cache.get(b"k") == [[PLAIN]]


def test_where_it_cannot_be_it_finds_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path in (tmp_path / "file" / "cache.sqlite", tmp_path):
        with ResultCache(path) as cache:
            cache.put(b"k", [[PLAIN]])
            assert cache.get(b"k") is None


@pytest.mark.parametrize("value", [b"", b"x", b"\x78\x9c", 1, None, "text"])
def test_a_value_that_is_none_is_not_found(tmp_path: Path, value: object) -> None:
    import sqlite3
    from contextlib import closing

    path = tmp_path / "cache.sqlite"
    ResultCache(path).close()
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("INSERT INTO results VALUES (?, 1, ?)", (b"k", value))
        connection.commit()
    with ResultCache(path) as cache:
        assert cache.get(b"k") is None


def test_the_oldest_make_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache_module, "_MOST_BYTES", 1_000)
    cache = ResultCache(tmp_path / "cache.sqlite")
    for number in range(50):
        cache.put(bytes([number]), [[PLAIN]])
    assert cache.get(bytes([3])) is not None
    cache.close()
    with ResultCache(tmp_path / "cache.sqlite") as cache:
        left = [number for number in range(50) if cache.get(bytes([number])) is not None]
    assert 3 in left
    assert 49 in left
    assert 2 not in left
    assert len(left) < 10


def _put_many(path: Path, first: int) -> None:
    cache = ResultCache(path)
    for number in range(first, first + 100):
        cache.put(number.to_bytes(2), [[PLAIN]])
    cache.close()


def test_two_processes_may_use_it_at_once(tmp_path: Path) -> None:
    path = tmp_path / "cache.sqlite"
    context = multiprocessing.get_context("spawn")
    processes = [context.Process(target=_put_many, args=(path, first)) for first in (0, 100)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0, 0]
    with ResultCache(path) as cache:
        found = [number for number in range(200) if cache.get(number.to_bytes(2)) is not None]
    assert found == list(range(200))


def test_what_was_put_is_there_at_once_and_holds_up_nobody(tmp_path: Path) -> None:
    path = tmp_path / "cache.sqlite"
    with ResultCache(path) as first, ResultCache(path) as second:
        first.put(b"1", [[PLAIN]])
        second.put(b"2", [[FULL]])
        assert (first.get(b"2"), second.get(b"1")) == ([[FULL]], [[PLAIN]])
