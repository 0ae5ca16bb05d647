"""The file that keeps summaries that were paid for."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
import threading
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_build.errors import SummaryError
from kb_build.summaries.store import BadAnswer, SentBatch, SummaryStore
from kb_build.summaries.types import PageSummary, summary_key

if TYPE_CHECKING:
    from pathlib import Path

API = "http://127.0.0.1/"


def one(number: int, text: str = "Cloth settings.") -> PageSummary:
    return PageSummary(summary_key(str(number), "page-1", "m"), text, "claude", "m", "page-1")


@pytest.fixture
def store(tmp_path: Path) -> SummaryStore:
    return SummaryStore(tmp_path / "new folder" / "summaries #1?.sqlite")


def sent(nonce: str, *numbers: int, batch_id: str | None = None) -> SentBatch:
    items = {f"{nonce}-{number}": one(number).key for number in numbers}
    return SentBatch(nonce, batch_id, API, "m", "page-1", 1.0, items)


def test_the_key_depends_on_text_prompt_and_model():
    keys = {
        summary_key(*parts) for parts in (("a", "b", "c"), ("x", "b", "c"), ("a", "x", "c"), ("a", "b", "x"))
    }
    assert len(keys) == 4
    assert all(len(key) == 64 for key in keys)


def test_what_was_added_is_found_by_another_store_on_the_same_file(store):
    assert store.add([one(1), one(2)]) == 2
    again = SummaryStore(store.path)
    assert again.get([one(1).key, one(3).key]) == {one(1).key: one(1)}


def test_phrases_are_kept_with_the_summary(store):
    searched = PageSummary(one(1).key, "Cloth.", "claude", "m", "page-2", ("flag in the wind", "table cloth"))
    store.add([searched])
    assert SummaryStore(store.path).get([searched.key]) == {searched.key: searched}


def of_the_first_version(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with closing(sqlite3.connect(path)) as db:
        db.execute(
            "CREATE TABLE summaries (key TEXT PRIMARY KEY, text TEXT NOT NULL, method TEXT NOT NULL, "
            "model TEXT NOT NULL, prompt_version TEXT NOT NULL) WITHOUT ROWID"
        )
        db.execute("INSERT INTO summaries VALUES (?, 'Old.', 'claude', 'm', 'page-1')", [one(1).key])
        db.execute("PRAGMA user_version = 1")
        db.commit()


def test_a_file_of_the_first_version_keeps_its_summaries(store):
    of_the_first_version(store.path)
    assert store.add([one(2)]) == 1
    assert store.get([one(1).key])[one(1).key].text == "Old."


def test_a_colleagues_file_of_the_first_version_is_merged(store, tmp_path):
    of_the_first_version(tmp_path / "theirs.sqlite")
    assert store.merge(tmp_path / "theirs.sqlite") == 1
    assert store.get([one(1).key])[one(1).key].phrases == ()


def test_the_first_summary_of_a_page_stays(store):
    store.add([one(1)])
    assert store.add([one(1, "Another."), one(2)]) == 1
    assert store.get([one(1).key])[one(1).key].text == "Cloth settings."


def test_thousands_of_keys_can_be_looked_up_at_once(store):
    summaries = [one(number) for number in range(3000)]
    store.add(summaries)
    assert len(store.get([summary.key for summary in summaries])) == 3000


def test_a_colleagues_copy_is_merged(store, tmp_path):
    theirs = SummaryStore(tmp_path / "theirs.sqlite")
    theirs.add([one(1, "Theirs."), one(2)])
    theirs.announce(sent("aaaa", 7))
    store.add([one(1)])
    assert store.merge(theirs.path) == 1
    assert store.count() == 2
    assert store.get([one(1).key])[one(1).key].text == "Cloth settings."
    assert store.under_way(API) == []


def test_a_merge_leaves_out_invalid_summaries(store, tmp_path):
    theirs = SummaryStore(tmp_path / "theirs.sqlite")
    theirs.add(
        [
            one(1, "x" * 601),
            one(2, "a\x1b[2J"),
            one(3, ""),
            PageSummary("short", "x", "claude", "m", "p"),
            one(4),
        ]
    )
    theirs.add([PageSummary(one(5).key, "chosen", "extractive", "m", "p")])
    assert store.merge(theirs.path) == 1


def test_a_merge_does_not_write_to_the_other_file(store, tmp_path):
    theirs = SummaryStore(tmp_path / "theirs.sqlite")
    theirs.add([one(1)])
    before = theirs.path.read_bytes()
    store.merge(theirs.path)
    assert theirs.path.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["new folder", "theirs.sqlite"]


def test_a_merge_of_a_file_that_is_not_there_says_so(store, tmp_path):
    with pytest.raises(SummaryError, match="No summary store at"):
        store.merge(tmp_path / "nowhere.sqlite")


@pytest.mark.parametrize("content", [b"not a database at all" * 100, b"SQLite format 3\x00" + b"\xff" * 4000])
def test_a_damaged_file_is_named_with_what_to_do(store, content):
    store.path.parent.mkdir(parents=True)
    store.path.write_bytes(content)
    with pytest.raises(SummaryError, match=r"summaries #1\?\.sqlite cannot be used.*move it away"):
        store.get(["x"])
    with pytest.raises(SummaryError, match="cannot be read as a colleague's summaries"):
        SummaryStore(store.path.with_name("mine.sqlite")).merge(store.path)


def test_another_programs_database_is_left_alone(store):
    store.path.parent.mkdir(parents=True)
    with closing(sqlite3.connect(store.path)) as db:
        db.execute("CREATE TABLE letters (body TEXT)")
    with pytest.raises(SummaryError, match="not a summary store"):
        store.add([one(1)])
    with closing(sqlite3.connect(store.path)) as db:
        assert db.execute("SELECT name FROM sqlite_schema").fetchall() == [("letters",)]


def test_a_newer_file_is_not_touched(store):
    store.add([one(1)])
    with closing(sqlite3.connect(store.path)) as db:
        db.execute("PRAGMA user_version = 99")
    with pytest.raises(SummaryError, match="newer SimWorlds"):
        store.get([one(1).key])


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(SummaryError, match="cannot be used"):
        SummaryStore(tmp_path / "file" / "summaries.sqlite").count()


def test_a_batch_is_remembered_from_before_it_is_sent_until_it_is_settled(store):
    store.announce(sent("aaaa", 1, 2))
    store.announce(sent("bbbb", 3, batch_id="msgbatch_2"))
    store.identify("aaaa", "msgbatch_1")
    assert store.under_way(API) == [
        sent("aaaa", 1, 2, batch_id="msgbatch_1"),
        sent("bbbb", 3, batch_id="msgbatch_2"),
    ]
    assert store.under_way("http://elsewhere/") == []
    bad = BadAnswer(one(2).key, "refusal", "no")
    store.settle("aaaa", [one(1)], [bad])
    assert [batch.nonce for batch in store.under_way(API)] == ["bbbb"]
    assert store.count() == 1
    assert store.failures([one(1).key, one(2).key]) == {one(2).key: [bad]}


def test_a_settlement_that_fails_leaves_the_batch_as_it_was(store):
    store.announce(sent("aaaa", 1))

    def summaries():
        yield one(1)
        raise RuntimeError("the process is in trouble")

    with pytest.raises(RuntimeError):
        store.settle("aaaa", summaries(), [])
    assert store.count() == 0
    assert store.under_way(API) == [sent("aaaa", 1)]


def test_many_threads_write_at_once_and_nothing_is_lost(store):
    def write(start: int) -> None:
        for number in range(start, start + 20):
            SummaryStore(store.path).add([one(number), one(number + 1)])

    threads = [threading.Thread(target=write, args=(start * 10,)) for start in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert store.count() == 51


def test_a_process_killed_while_writing_leaves_a_whole_file(store):
    code = """
import itertools, sys
from pathlib import Path
from kb_build.summaries.store import SummaryStore
from kb_build.summaries.types import PageSummary, summary_key
store = SummaryStore(Path(sys.argv[1]))
for n in itertools.count():
    keys = [summary_key(f"{n} {m}", "p", "m") for m in range(100)]
    store.add([PageSummary(key, "text " * 50, "claude", "m", "p") for key in keys])
    print(n, flush=True)
"""
    repo = REPO
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(store.path)], stdout=subprocess.PIPE, text=True, cwd=repo
    )
    assert process.stdout is not None
    for _ in range(5):
        process.stdout.readline()
    process.kill()
    process.wait(30)
    process.stdout.close()
    count = store.count()
    assert count >= 500
    assert count % 100 == 0, "every transaction is there wholly or not at all"
    with closing(sqlite3.connect(store.path)) as db:
        assert db.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_the_lock_of_a_killed_process_is_free(store):
    code = """
import sys
from pathlib import Path
from kb_build.summaries.store import SummaryStore
with SummaryStore(Path(sys.argv[1])).exclusive():
    print("locked", flush=True)
    sys.stdin.read()
"""
    repo = REPO
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(store.path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=repo,
    )
    assert process.stdout is not None
    assert process.stdin is not None
    process.stdout.readline()
    lines: list[str] = []

    def progress(done: int, total: int, line: str) -> None:
        lines.append(line)
        process.kill()

    with store.exclusive(progress):
        pass
    process.wait(30)
    process.stdin.close()
    process.stdout.close()
    assert len(lines) == 1
    assert "waiting" in lines[0]
