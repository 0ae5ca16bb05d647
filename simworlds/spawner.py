"""A thread that never ends, to start processes in.

On Linux, a process that asks to end with its parent ends with the *thread* that started it. Threads that serve one
call and go would take Blender with them.
"""

from __future__ import annotations

import queue
import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

_T = TypeVar("_T")
_Job = tuple["Callable[[], Any]", "Future[Any]"]


class _Nursery:
    def __init__(self) -> None:
        self._jobs: queue.SimpleQueue[_Job] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def run(self, job: Callable[[], _T]) -> _T:
        with self._lock:
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._serve, name="starts Blenders", daemon=True)
                self._thread.start()
        future: Future[_T] = Future()
        self._jobs.put((job, future))
        return future.result()

    def _serve(self) -> None:
        while True:
            job, future = self._jobs.get()
            try:
                future.set_result(job())
            except BaseException as error:
                future.set_exception(error)
            del job, future


_nursery = _Nursery()


def started_for_good(start: Callable[[], _T]) -> _T:
    """What ``start`` returns, or raises, called in the thread that never ends."""
    return _nursery.run(start)
