"""Whatever happens while a page is read costs that page alone."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.errors import SourceError
from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from kb_build.pages.readers.workers import PageBudget, PageWork, read_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from kb_build.pages.page import Page

PAGES = [f"page {number}" for number in range(30)]
MISCHIEF = "page 17"
MIB = 1 << 20


def spin() -> None:
    while True:
        pass


def fill_memory() -> None:
    hoard = [bytearray(8 * MIB) for _ in range(1_000)]
    assert hoard is None


def fall() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def fail() -> None:
    raise KeyError("no such thing")


def wait_for_ever() -> None:
    time.sleep(10_000)


ACTS = [
    pytest.param(spin, "it took more than 0.5 s of computing", id="computes without end"),
    pytest.param(wait_for_ever, "it took more than 3 s", id="waits without end"),
    pytest.param(fill_memory, "it took more than 64 MiB of memory", id="fills the memory"),
    pytest.param(fall, "did not survive: it was ended by SIGKILL", id="is killed"),
    pytest.param(fail, "KeyError: 'no such thing'", id="raises"),
]
BUDGET = PageBudget(cpu_seconds=0.5, memory=64 * MIB)


def budget_for(act: Callable[[], object]) -> PageBudget:
    """Time by the clock is short only where it ends the page: under load, computing takes many times as long."""
    return replace(BUDGET, seconds=3) if act is wait_for_ever else BUDGET


def reads(act: Callable[[], object]) -> Callable[[str], str]:
    def read(name: str) -> str:
        if name == MISCHIEF:
            act()
        return name.upper()

    return read


@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.whole), 2])
@pytest.mark.parametrize(("act", "reason"), ACTS)
def test_one_page_fails_and_the_others_are_read(act: Callable[[], object], reason: str, jobs: int) -> None:
    found = read_apart(PAGES, PageWork(reads(act)), jobs=jobs, budget=budget_for(act))
    assert found.answers == {name: name.upper() for name in PAGES if name != MISCHIEF}
    assert found.failed.keys() == {MISCHIEF}
    assert reason in found.failed[MISCHIEF]


@pytest.mark.parametrize(
    ("act", "reason"), [ACTS[0], *ACTS[2:], pytest.param(*ACTS[1].values, marks=pytest.mark.whole)]
)
def test_what_a_process_holds_of_its_pages_is_gathered_once(act: Callable[[], object], reason: str) -> None:
    held: list[str] = []
    merged: list[tuple[Sequence[str], list[str]]] = []

    def read(name: str) -> None:
        reads(act)(name)
        held.append(name)

    work = PageWork(read, lambda: held, lambda names, gathered: merged.append((names, gathered)))
    found = read_apart(PAGES, work, jobs=2, budget=budget_for(act))
    assert sorted(name for names, _ in merged for name in names) == sorted(set(PAGES) - {MISCHIEF})
    assert all(set(names) <= set(gathered) for names, gathered in merged)
    assert found.answers.keys() == set(PAGES) - {MISCHIEF}
    assert reason in found.failed[MISCHIEF]
    assert held == []


def test_the_page_whose_share_cannot_be_handed_over_is_found() -> None:
    held: list[str] = []

    def read(name: str) -> None:
        held.append("x" * MIB if name == MISCHIEF else name)

    work = PageWork(read, lambda: held, lambda _names, _gathered: None)
    found = read_apart(PAGES, work, jobs=2, budget=PageBudget(gathered=MIB // 2))
    assert found.failed == {MISCHIEF: "what was read of it is too large"}
    assert found.answers.keys() == set(PAGES) - {MISCHIEF}


def test_a_page_of_which_too_much_is_read_fails() -> None:
    found = read_apart(
        PAGES,
        PageWork(lambda name: "x" * MIB if name == MISCHIEF else name),
        jobs=1,
        budget=PageBudget(answer=MIB),
    )
    assert found.failed == {MISCHIEF: "what was read of it is too large"}


def test_a_file_that_grows_without_end_fails(tmp_path: Path) -> None:
    def write(name: str) -> str:
        if name == MISCHIEF:
            with (tmp_path / "file").open("wb") as file:
                while True:
                    file.write(bytes(MIB))
        return name

    found = read_apart(PAGES, PageWork(write), jobs=1, budget=PageBudget(written=4 * MIB))
    assert found.failed == {MISCHIEF: "OSError: [Errno 27] File too large"}
    assert (tmp_path / "file").stat().st_size == 4 * MIB


def test_a_page_does_not_pay_for_those_before_it() -> None:
    hoard: list[bytearray] = []

    def read(name: str) -> str:
        hoard.append(bytearray(10 * MIB))
        return name

    found = read_apart(PAGES, PageWork(read), jobs=1, budget=PageBudget(memory=32 * MIB))
    assert found.answers.keys() == set(PAGES)
    assert not found.failed


def test_pages_that_are_slow_one_and_all_have_an_end() -> None:
    budget = PageBudget(cpu_seconds=0.2, cpu_seconds_in_all=1, cpu_seconds_each=0)
    found = read_apart(PAGES, PageWork(lambda _: spin()), jobs=2, budget=budget)
    assert found.failed.keys() == set(PAGES)
    assert "other pages took the time that there is for all" in found.failed.values()


def test_an_unreadable_disk_ends_the_reading_and_all_processes() -> None:
    def read(name: str) -> str:
        if name == MISCHIEF:
            raise SourceError("the disk is gone")
        return name

    with pytest.raises(SourceError, match="the disk is gone"):
        read_apart(PAGES, PageWork(read), jobs=2, budget=BUDGET)
    assert multiprocessing.active_children() == []


@pytest.mark.parametrize(("read", "form"), [(read_rst, "rst"), (read_html, "html")])
def test_a_process_with_threads_reads_pages_elsewhere(
    tmp_path: Path, read: Callable[..., list[Page]], form: str
) -> None:
    text = "Page\n====\n\nText.\n" if form == "rst" else "<h1>Page</h1><p>Text.</p>"
    (tmp_path / f"page.{form}").write_text(text)
    alone = read(tmp_path, source="manual", version="5.1")
    seen: list[tuple[int, int]] = []

    def report(done: int, total: int) -> None:
        seen.append((done, total))

    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        beside = read(tmp_path, source="manual", version="5.1", progress=report)
        (tmp_path / "empty").mkdir()
        with pytest.raises(SourceError, match="holds no"):
            read(tmp_path / "empty", source="manual", version="5.1")
    finally:
        stop.set()
        thread.join()
    assert beside == alone
    assert seen
