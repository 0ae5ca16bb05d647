"""Work in a forked process, and what happens where there is none."""

from __future__ import annotations

import multiprocessing.context
import os

import pytest

from simworlds.errors import UserError
from simworlds.forked import beside

pytestmark = pytest.mark.skipif(os.name != "posix", reason="nothing is forked there")


def test_what_is_computed_beside_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simworlds.forked.can_fork", lambda: True)
    with beside(os.getpid) as result:
        assert result() != os.getpid()


def test_a_fault_of_the_users_is_raised_here() -> None:
    def wrong() -> None:
        raise UserError("wrong")

    with beside(wrong) as result, pytest.raises(UserError, match="wrong"):
        result()


@pytest.mark.parametrize("lacking", ["start", "Pipe", "fork"])
def test_where_no_process_can_be_started_it_is_computed_here(
    monkeypatch: pytest.MonkeyPatch, lacking: str
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("simworlds.forked.can_fork", lambda: lacking != "fork")
    context = multiprocessing.context
    monkeypatch.setattr(context.ForkProcess, "start", refused) if lacking == "start" else None
    monkeypatch.setattr(context.BaseContext, "Pipe", refused) if lacking == "Pipe" else None
    with beside(os.getpid) as result:
        assert result() == os.getpid()


def test_a_body_that_fails_ends_the_process_and_is_told() -> None:
    with pytest.raises(OSError, match="of the body"), beside(lambda: 1):
        raise OSError("of the body")
