"""Work in processes of their own, which Blender outlives."""

from __future__ import annotations

import io
import json
import os

import pytest

from kb_build.blender.inside.apart import Beside, can_work_apart
from kb_build.blender.inside.wire import Writer

pytestmark = pytest.mark.skipif(not can_work_apart(), reason="this system cannot fork")


def test_what_was_found_meanwhile_comes_after_what_was_written() -> None:
    file = io.StringIO()
    write = Writer(file)
    meanwhile = Beside("searching", lambda write: [write("found", path=path) for path in ("a", "ß")])
    write("own", path="b")
    meanwhile.into(write)
    rows = [json.loads(line) for line in file.getvalue().splitlines()]
    assert rows == [
        {"record": "own", "path": "b"},
        {"record": "found", "path": "a"},
        {"record": "found", "path": "ß"},
    ]
    assert write.count == 3


def test_what_was_found_before_a_fault_is_kept_with_it() -> None:
    def find(write: Writer) -> None:
        write("found", path="a")
        raise ValueError("no more")

    file = io.StringIO()
    Beside("searching", find).into(Writer(file))
    found, fault = [json.loads(line) for line in file.getvalue().splitlines()]
    assert found["path"] == "a"
    assert fault["step"] == "searching"
    assert fault["traceback"].endswith("ValueError: no more\n")


def test_an_end_of_blender_meanwhile_is_an_error() -> None:
    file = io.StringIO()
    with pytest.raises(RuntimeError, match="Blender ended, with status"):
        Beside("searching", lambda _write: os.abort()).into(Writer(file))
    assert not file.getvalue()
