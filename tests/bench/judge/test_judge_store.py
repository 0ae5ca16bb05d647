"""Answers are kept whole, read only if sound, and asked for once, whoever asks and whenever he is killed."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import pytest
from judge_apis import PROMPT, Gate, film

from bench.judge.errors import NotJudged
from bench.judge.judge import judge

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def judged(api, frames, store):
    return judge(PROMPT, frames, static=False, provider=api.provider(), cache=store)


def entry(store: Path, kind: str) -> Path:
    [path] = (store / kind).glob("*.json")
    return path


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "cut off": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "other bytes": lambda data: b"\xff\x00" * 32,
    "of another shape": lambda data: b'{"sha256": "0", "value": {}}',
    "a list": lambda data: b"[]",
    "nested without end": lambda data: b"[" * 100_000,
    "a changed answer": lambda data: data.replace(b'"holds": false', b'"holds": true', 1).replace(
        b"a papaya", b"a mango", 1
    ),
}


@pytest.mark.parametrize("kind", ["items", "verdicts"])
@pytest.mark.parametrize("how", DAMAGE)
def test_a_damaged_entry_is_ignored_and_replaced(claude, frames, store, kind, how):
    first = judged(claude, frames, store)
    path = entry(store, kind)
    sound = path.read_bytes()
    path.write_bytes(DAMAGE[how](sound))
    assert path.read_bytes() != sound
    assert judged(claude, frames, store) == first
    assert path.read_bytes() == sound
    judged(claude, frames, store)
    assert claude.stages() == ["items", "verdicts", kind]


def test_entries_are_json_that_people_can_read(claude, frames, store):
    judged(claude, frames, store)
    assert json.loads(entry(store, "items").read_text("utf-8"))["value"]["items"][0]["words"] == "two parrots"
    assert [path.suffix for path in (store / "verdicts").iterdir()] == [".json"]


def test_nothing_is_asked_if_answers_cannot_be_kept(claude, frames, store):
    store.write_text("a file")
    with pytest.raises(NotJudged, match="Cannot keep answers") as caught:
        judged(claude, frames, store)
    assert (caught.value.reason, claude.server.requests) == ("cache", [])


def test_an_answer_that_cannot_be_written_is_still_returned(claude, frames, store, caplog):
    store.mkdir()
    (store / "verdicts").write_text("a file")
    assert judged(claude, frames, store).score == 0.9
    assert "this question will be asked again" in caplog.text


def test_two_processes_with_the_same_question_ask_once(claude, frames, store):
    gate = Gate()
    claude.script.before = gate
    with ThreadPoolExecutor(2) as pool:
        both = [pool.submit(judged, claude, frames, store) for _ in range(2)]
        assert gate.reached.wait(60)
        gate.go.set()
        one, other = (each.result() for each in both)
    assert one == other
    assert claude.stages() == ["items", "verdicts"]


def test_killed_between_the_items_and_the_verdicts_the_items_are_not_asked_again(claude, store, tmp_path):
    frames = film(tmp_path / "frames")
    gate = Gate()
    claude.script.before = gate
    command = [
        sys.executable,
        "-m",
        "simworlds",
        "bench",
        "judge",
        *map(str, frames),
    ]
    command += ["--prompt", PROMPT, "--base-url", claude.server.base_url, "--cache", str(store), "--json"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        assert gate.reached.wait(60)
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    gate.go.set()
    claude.server.wait_for("POST /v1/messages", 2)
    assert claude.stages() == ["items", "verdicts"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["judgements"][0]["score"] == 0.9
    assert claude.stages() == ["items", "verdicts", "verdicts"]
