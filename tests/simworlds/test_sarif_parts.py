"""What logs in SARIF of every command have in common."""

from __future__ import annotations

from typing import Any

import pytest

from simworlds.formats.sarif import invocations, notification, sarif_log, tell_apart, uri_of


@pytest.mark.parametrize(
    ("name", "uri"),
    [
        ("a dir/ä#?.py", "a%20dir/%C3%A4%23%3F.py"),
        ("/tmp/a b.blend", "file:///tmp/a%20b.blend"),
        ("scenes/a\udcff.blend", "scenes/a%3F.blend"),
        ("/tmp/a\udcff.blend", "file:///tmp/a%FF.blend"),
    ],
)
def test_any_path_is_a_uri(name: str, uri: str) -> None:
    assert uri_of(name) == uri


def test_a_run_without_notifications_was_successful() -> None:
    assert invocations([]) == [{"executionSuccessful": True, "toolExecutionNotifications": []}]
    (failed,) = invocations([notification("There is no file x.")])
    assert not failed["executionSuccessful"]
    assert failed["toolExecutionNotifications"][0]["message"] == {"text": "There is no file x."}


def test_each_of_several_runs_has_an_id() -> None:
    alone: list[dict[str, Any]] = [{}]
    tell_apart(alone, ["a/"])
    assert sarif_log(alone)["runs"] == [{}]
    two: list[dict[str, Any]] = [{}, {}]
    tell_apart(two, ["a/", "b/"])
    assert [run["automationDetails"]["id"] for run in two] == ["a/", "b/"]
