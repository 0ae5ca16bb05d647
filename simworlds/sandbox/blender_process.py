"""One Blender process: started in its sandbox, spoken to over a socket, killed with everything it has started.

How far the channel can be trusted. Printed output never reaches it, and bytes that code writes to it by accident lack a
signature: the process is then killed and its replies are ignored. But hostile code runs in the same process as the
worker and can find the key in its memory, so it can reply in the worker's name. It gains little. Tickets are random, so
it cannot answer later calls; between calls the process is stopped; and every reply is a claim that is read by a model
with bounds before anything is done by it (see replies.py). A reply that breaks them ends the process.
"""

from __future__ import annotations

import contextlib
import logging
import os
import secrets
import selectors
import socket
import subprocess
import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic

from simworlds.processes import kill_group, signal_name, spawn
from simworlds.sandbox.captured_output import CapturedOutput
from simworlds.sandbox.errors import (
    BlenderError,
    CannotStart,
    Died,
    Interrupted,
    LimitExceeded,
    Lost,
    MissingModule,
    NeverBegan,
    Refusal,
    TookTooLong,
    ToolBroke,
    Untrustworthy,
)
from simworlds.sandbox.inside import channel
from simworlds.sandbox.replies import (
    AnswerMessage,
    Malformed,
    ProgressMessage,
    Reader,
    T,
    parse_message,
    parse_value,
)
from simworlds.sandbox.watch.watched_process import WatchedProcess, innermost_process

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Iterator

    from simworlds.sandbox.launch import Launch

    Progress = Callable[[float, float | None, str], None]

_LOG = logging.getLogger(__name__)

START_SECONDS = 60.0
_LONGEST_TOLD = 300
_CHECK_SECONDS = 0.05  # between two checks whether the call was cancelled or a limit exceeded
_END_SECONDS = 5.0
_EXIT_SECONDS = 1.0  # in which a process that has closed its channel is expected to end
_CHUNK = 1 << 18
_NO_MEMORY = (
    "bad_alloc",
    "returns null",
    "ut of memory",
    "MemoryError",
    "annot allocate",
    "failed to map segment",
)


@dataclass(frozen=True, slots=True)
class WorkerReply(Generic[T]):
    """What a tool returned, as its reader made it, what was printed meanwhile, and how many seconds it ran.

    ``left``: what it left behind and cannot be undone, in words.
    """

    value: T
    stdout: str
    stderr: str
    seconds: float
    left: tuple[str, ...] = ()


class _PrintedLines:
    """Passes on the lines that a tool prints as its progress."""

    def __init__(self, output: CapturedOutput, progress: Progress) -> None:
        self._output, self._progress = output, progress
        self._seen = 0

    def look(self) -> None:
        """Passes on the last line if there is a new one."""
        if self._output.lines > self._seen:
            self._seen = self._output.lines
            self._progress(self._seen, None, self._output.last_line)


class BlenderProcess:
    """A running Blender, for one thread at a time. Raises CannotStart if it does not start."""

    def __init__(self, launch: Launch) -> None:
        launch.prepare()
        self._launch = launch
        self._closed = False
        self._told = ""  # what the call that runs told last
        self._stdout, self._stderr = CapturedOutput(), CapturedOutput()
        self._usage = launch.usage
        self._worker = WatchedProcess(0)
        ours, theirs = socket.socketpair()
        try:
            self._process = spawn(
                launch.command(theirs.fileno()),
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=launch.environment,
                cwd=launch.workspace.mount,
                pass_fds=(theirs.fileno(),),
            )
        except OSError as error:
            ours.close()
            raise CannotStart(f"{launch.runtime.executable} cannot be started: {error}") from error
        except BlenderError:
            ours.close()
            raise
        finally:
            theirs.close()
        self._socket = ours
        key = secrets.token_bytes(channel.KEY_BYTES)
        self._encode = channel.Encoder(key, channel.SUPERVISOR)
        self._decode = channel.Decoder(key, channel.WORKER, launch.program.largest_reply)
        self._arrived: deque[dict[str, Any]] = deque()
        self._selector = selectors.DefaultSelector()
        self._selector.register(ours, selectors.EVENT_READ, None)
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        for source, printed in ((self._process.stdout, self._stdout), (self._process.stderr, self._stderr)):
            os.set_blocking(source.fileno(), False)
            self._selector.register(source, selectors.EVENT_READ, printed)
        try:
            ours.sendall(key)
            self._await_start()
        except (Lost, OSError) as error:
            why = self._ending() if isinstance(error, Died) else error
            self.kill()
            output = f"{self._stderr.text}{self._stdout.text}".rstrip()
            raise CannotStart(f"Blender did not start: {why}" + (f"\n{output}" if output else "")) from error
        except BaseException:
            self.kill()
            raise
        self.inner = innermost_process(self._process.pid)
        self._worker = WatchedProcess(self.inner)
        self._usage.watch(self._worker)
        self._worker.pause()

    @property
    def started(self) -> int:
        """The process that was started: Blender or the bubblewrap around it. ``inner`` is always Blender."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return not self._closed and self._process.poll() is None

    def call(  # noqa: PLR0913 - what a caller may want to say of a call
        self,
        tool: str,
        arguments: dict[str, Any],
        read: Reader[T],
        *,
        timeout: float,
        what: str = "",
        limited: bool = True,
        progress: Progress | None = None,
        printed: bool = False,
        cancelled: threading.Event | None = None,
    ) -> WorkerReply[T]:
        """Runs one tool; ``timeout`` in seconds, ``what`` names it in errors. ``progress`` gets (done, total, text):
        what the tool reports; with ``printed``, how many lines it has printed and the last one, if it reports nothing.

        ``read`` makes a value of what the tool returned; what it cannot read is a breach, which ends the process.
        ``limited``: Blender is killed if it exceeds the limits of disk, memory and threads.

        Raises Refusal and ToolBroke, after which Blender still runs, and Lost, after which it has been killed, as after
        any other exception (of ``progress``, say).
        """
        what = what or tool
        if self._closed:
            raise NeverBegan(f"Blender had ended before {what} began", ending="it had been stopped")
        ticket = secrets.token_hex(8)
        self._drain()
        self._stdout.clear()
        self._stderr.clear()
        try:
            request = self._encode({"ticket": ticket, "tool": tool, "arguments": arguments})
        except channel.TooLarge as error:
            raise Refusal(f"The arguments of {what} are too large: {error}.") from error
        try:
            self._told = ""
            self._worker.mark()
            self._worker.go_on()
            self._send(request, what, timeout)
            lines = _PrintedLines(self._stdout, progress) if printed and progress is not None else None
            answer = self._answer(ticket, what, timeout, progress, cancelled, printed=lines, limited=limited)
            self._drain()
            return self._reply(answer, read)
        except (Refusal, ToolBroke):
            raise
        except Malformed as error:
            fault = self._untrustworthy(what, error)
            self.kill()
            raise fault from error
        except BaseException:
            self.kill()
            raise

    def _answer(  # noqa: PLR0913 - as of a call
        self,
        ticket: str,
        what: str,
        timeout: float,
        progress: Progress | None,
        cancelled: threading.Event | None,
        *,
        printed: _PrintedLines | None,
        limited: bool,
    ) -> AnswerMessage:
        """Reports progress until the answer has come, then stops the process. Raises Lost, Malformed."""
        for message in self._messages(what, timeout, cancelled, printed=printed, limited=limited):
            claim = parse_message(message)
            if claim.ticket != ticket:
                # Code has answered the call before in the worker's name, and the real answer came late.
                raise NeverBegan(
                    f"Code had sent a false reply before {what} began; it is ignored, and Blender was stopped"
                )
            if isinstance(claim, ProgressMessage):
                self._told = claim.progress[-1][:_LONGEST_TOLD]
                if progress is not None:
                    progress(*claim.progress)
                continue
            threads = 0
            if self._worker.has_new_threads():
                self._worker.go_on()
                threads = self._worker.threads_left()
            self._worker.pause()
            if threads and not claim.left:
                claim = claim.model_copy(update={"left": [_of_its_own(threads)]})
            return claim
        raise AssertionError("messages end with an exception")

    def _reply(self, answer: AnswerMessage, read: Reader[T]) -> WorkerReply[T]:
        """Raises Refusal, ToolBroke, and Malformed."""
        if answer.missing is not None:
            raise MissingModule(answer.missing)
        if answer.refused is not None:
            raise Refusal(answer.refused)
        if answer.failed is not None:
            raise ToolBroke(answer.failed, answer.traceback)
        value = parse_value(read, answer.value)
        return WorkerReply(value, self._stdout.text, self._stderr.text, answer.seconds, tuple(answer.left))

    def _await_start(self) -> None:
        """Raises Lost."""
        if next(self._messages("its start", START_SECONDS, limited=False)) != {"ready": True}:
            raise self._untrustworthy("its start", Malformed("it is not ready"))

    def _send(self, request: bytes, what: str, timeout: float) -> None:
        try:
            self._socket.settimeout(timeout)
            self._socket.sendall(request)
        except TimeoutError:
            raise self._too_long(what, timeout) from None
        except OSError:
            ending = self._ending()
            raise NeverBegan(f"Blender had ended before {what} began: {ending}", ending=ending) from None

    def _messages(
        self,
        what: str,
        timeout: float,
        cancelled: threading.Event | None = None,
        *,
        printed: _PrintedLines | None = None,
        limited: bool = True,
    ) -> Iterator[dict[str, Any]]:
        """The worker's messages until the deadline. Output is read meanwhile, so that Blender never waits for it.

        Raises Lost. The limits are checked now and then, and after each message.
        """
        started = time.monotonic()
        deadline = started + timeout
        while True:
            now = time.monotonic()
            self._check(what, now - started, cancelled, limited=limited)
            if now > deadline:
                raise self._too_long(what, timeout)
            for key, _ in self._selector.select(min(_CHECK_SECONDS, max(0.0, deadline - now))):
                if key.data is not None:
                    self._read_printed(key)
                    continue
                self._arrived += self._receive(what, now - started)
            if printed is not None:
                printed.look()
            while self._arrived:
                message = self._arrived.popleft()
                if limited and "progress" not in message:
                    if (
                        not self._worker.has_new_threads()
                    ):  # nothing is left that may work on: stopped once, not twice
                        self._worker.pause()
                    self._check_usage(what, at_end=True)
                yield message

    def _check(self, what: str, seconds: float, cancelled: threading.Event | None, *, limited: bool) -> None:
        if cancelled is not None and cancelled.is_set():
            raise Interrupted(
                f"{_capital(what)} was cancelled after {seconds:.1f} s, and Blender was stopped",
                self._last_output(),
            )
        if limited:
            self._check_usage(what)

    def _check_usage(self, what: str, *, at_end: bool = False) -> None:
        if (excess := self._usage.excess(at_end=at_end)) is not None:
            raise LimitExceeded(f"{_capital(what)} {excess}. Blender was stopped", self._last_output())

    def _receive(self, what: str, seconds: float) -> list[dict[str, Any]]:
        unread = False
        try:
            data = self._socket.recv(_CHUNK)
        except ConnectionResetError:
            data, unread = b"", True
        except OSError:
            data = b""
        if data:
            try:
                return self._decode.feed(data)
            except channel.ForgedFrame as error:
                raise self._untrustworthy(what, error) from error
        self._drain()
        ending = self._ending()
        if unread:  # the request
            raise NeverBegan(f"Blender had ended before {what} began: {ending}", self._last_output(), ending)
        raise Died(f"Blender ended {seconds:.1f} s into {what}: {ending}", self._last_output(), ending)

    def _too_long(self, what: str, timeout: float) -> TookTooLong:
        told = f" (the last it told: {self._told})" if self._told else ""
        return TookTooLong(
            f"{_capital(what)} ran past its deadline of {timeout:g} s{told}, and Blender was stopped",
            self._last_output(),
        )

    def _untrustworthy(self, what: str, fault: Exception) -> Untrustworthy:
        return Untrustworthy(
            f"During {what}, code wrote something to SimWorlds' channel that is not a valid reply ({fault}); it is "
            "ignored, and Blender was stopped",
            self._last_output(),
        )

    def _read_printed(self, key: selectors.SelectorKey) -> bool:
        try:
            data = os.read(key.fd, _CHUNK)
        except BlockingIOError:
            return False
        except OSError:
            data = b""
        if not data:
            with contextlib.suppress(KeyError):
                self._selector.unregister(key.fileobj)
            return False
        assert isinstance(key.data, CapturedOutput)
        key.data.add(data)
        return True

    def _drain(self) -> None:
        """Reads what has been printed so far."""
        for key in [key for key in self._selector.get_map().values() if key.data is not None]:
            deadline = time.monotonic() + 1.0
            while self._read_printed(key) and time.monotonic() < deadline:
                pass

    def _last_output(self) -> str:
        return (self._stdout.text + self._stderr.text)[-2000:]

    def _ending(self) -> str:
        """How the process ended, in words."""
        try:
            code = self._process.wait(_EXIT_SECONDS)
        except subprocess.TimeoutExpired:
            return "its channel was closed from inside, or it became another program"
        if code > 128:  # bubblewrap reports a signal as a shell does
            code = 128 - code
        if code == channel.CHANNEL_LOST:
            return "its channel was closed from inside"
        if code >= 0:
            hint = ", as after bpy.ops.wm.quit_blender or os._exit" if code == 0 else ""
            return f"it was ended from inside, with exit code {code}{hint}"
        name = signal_name(code)
        if self._launch.group.ran_out_of_memory or any(word in self._last_output() for word in _NO_MEMORY):
            allowed = self._launch.sandbox.limits.memory / 1e9
            return f"it ran out of memory; the limit is {allowed:.1f} GB ({name})"
        if name == "SIGKILL":
            return "it was killed (SIGKILL), by the system because memory ran out, or by another process"
        return f"it crashed ({name})"

    def stop(self) -> None:
        """From any thread: kills the process. A running call raises Died."""
        if not self._closed and self._process.returncode is None:
            kill_group(self._process.pid)

    def kill(self) -> None:
        """Kills the process and everything it has started, and waits until they are gone. Later calls do nothing."""
        if self._closed:
            return
        self.stop()
        self._closed = True
        self._worker.close()
        try:
            self._process.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            # It waits for a device or a file server, and ends when that answers.
            _LOG.warning("Process %d was killed, but has not ended yet", self._process.pid)
        self._await_closed_pipes()
        self._selector.close()
        self._socket.close()
        for pipe in (self._process.stdout, self._process.stderr):
            assert pipe is not None
            pipe.close()

    def close(self) -> None:
        """Lets Blender end by itself, or kills it."""
        if not self._closed:
            self._worker.go_on()
            with contextlib.suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_END_SECONDS)
        self.kill()

    def _await_closed_pipes(self) -> None:
        """Waits until the last process that holds the pipes is gone: with bubblewrap that is a grandchild."""
        self._selector.unregister(self._socket)
        deadline = time.monotonic() + _END_SECONDS
        while self._selector.get_map() and (left := deadline - time.monotonic()) > 0:
            for key, _ in self._selector.select(left):
                self._read_printed(key)


def _of_its_own(threads: int) -> str:
    return f"{threads} thread{'s' if threads > 1 else ''} of its own still running"


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
