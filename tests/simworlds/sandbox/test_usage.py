"""The limits of what a sandboxed process may use, as they are measured from outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.watch import usage

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[HostileGround, HostileGround]:
    """Folders to watch; looking at them is quick, however slow this machine is at present."""
    monkeypatch.setattr(usage, "_QUICK_SECONDS", 1e6)
    (tmp_path / "workspace").mkdir()
    (tmp_path / "private").mkdir()
    return HostileGround(tmp_path / "workspace"), HostileGround(tmp_path / "private")


def test_counts_usage_of_both_folders_together(two: tuple[HostileGround, HostileGround]) -> None:
    watch = usage.UsageMonitor(two, ResourceLimits(disk=150_000, files=0))
    for number, folder in enumerate(two):
        assert watch.excess(at_end=True) is None
        for name in range(20):  # many files are no fault, where their number has no limit
            (folder.mount / f"{number}-{name}").write_bytes(bytes(4096))
    assert watch.excess(at_end=True) == "brought the run's files to 0 MB; the limit is 0 MB"


def test_counts_only_usage_beyond_the_initial_files(two: tuple[HostileGround, HostileGround]) -> None:
    for number in range(30):
        (two[0].mount / f"old{number}").write_text("x")
    watch = usage.UsageMonitor(two, ResourceLimits(files=10))
    assert watch.excess(at_end=True) is None
    (two[0].mount / "new").write_text("x")
    assert watch.excess(at_end=True) == "brought the run to more than 30 files"


def test_pauses_between_checks_except_at_the_end_of_a_call(
    two: tuple[HostileGround, HostileGround], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(usage, "_CHECK_SECONDS", 1e6)
    watch = usage.UsageMonitor(two, ResourceLimits(files=1))
    assert watch.excess() is None
    for number in range(5):
        (two[0].mount / str(number)).write_text("x")
    assert watch.excess() is None
    assert watch.excess(at_end=True) is not None


def test_removes_nothing_from_before_the_last_check(two: tuple[HostileGround, HostileGround]) -> None:
    watch = usage.UsageMonitor(two, ResourceLimits(files=3))
    (two[0].mount / "kept").write_text("x")
    assert watch.excess(at_end=True) is None
    since = watch.last_within_limits
    for number in range(5):
        (two[1].mount / str(number)).write_text("x")
    assert watch.excess(at_end=True) is not None
    assert watch.last_within_limits == since
    for folder in two:
        folder.remove_since(since)
    assert (two[0].mount / "kept").exists()
