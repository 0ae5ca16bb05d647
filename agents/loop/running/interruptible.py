"""A model that nobody waits for once the run has been asked to stop."""

from __future__ import annotations

import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.loop.errors import Stopping

if TYPE_CHECKING:
    from collections.abc import Callable

    from simworlds.llm.messages import Ask, Model, Turn

GRACE = 5.0  # seconds: an answer that comes sooner is paid for, and kept
_TICK = 0.1


@dataclass(frozen=True, slots=True)
class Interruptible:
    """Asks ``model`` in a thread of its own. Raises Stopping GRACE seconds after ``stop`` is set.

    The request is left alone then: it ends with the process, and is made again when the run is resumed.
    """

    model: Model
    stop: threading.Event

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """See Model."""
        answered: Future[Turn] = Future()

        def work() -> None:
            try:
                answered.set_result(self.model.answer(ask, on_text))
            except BaseException as error:
                answered.set_exception(error)

        threading.Thread(target=work, name=f"model of the {ask.role}", daemon=True).start()
        since: float | None = None
        while not answered.done():
            if self.stop.is_set():
                since = since or time.monotonic()
                if time.monotonic() - since >= GRACE:
                    raise Stopping(
                        f"You asked the run to stop. The {ask.role} had not answered; it is asked again."
                    )
            _wait(answered)
        return answered.result()


def _wait(answered: Future[Turn]) -> None:
    """Waits a moment; an interrupt (Ctrl-C) is noticed meanwhile."""
    try:
        answered.exception(timeout=_TICK)
    except TimeoutError:
        return
