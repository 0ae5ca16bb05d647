"""The user's open Blender, as tools call it. It is not ours: it is never killed, and may end or change at any time."""

from __future__ import annotations

import secrets
import socket
import threading
import time
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, ValidationError

from agents.blender.attached.open_blenders import About, OpenBlender, choose
from agents.blender.inside.attached.connection import link
from simworlds.sandbox.blender_process import WorkerReply
from simworlds.sandbox.errors import MissingModule, Refusal, ToolBroke
from simworlds.sandbox.inside import channel
from simworlds.sandbox.replies import (
    AnswerMessage,
    Malformed,
    ProgressMessage,
    Reader,
    T,
    Text,
    parse_message,
    parse_value,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from simworlds.sandbox.blender_process import Progress

_GRACE_SECONDS = 10.0  # after a call's deadline: what Blender itself does cannot be interrupted
_CHECK_SECONDS = 0.05
_SEND_SECONDS = 20.0
_LEAVING_SECONDS = 2.0
_STOP_SECONDS = 60.0  # for long work to be undone, once it is cancelled
_COPY_SECONDS = 5.0
_LONGEST_NOTE = 4000


class _OpenAnswer(AnswerMessage):
    """An answer of the open Blender: also what was printed, and what the user did since the last one."""

    stdout: Text = ""
    kind: Literal["", "busy", "large"] = ""
    events: list[Text] = Field(default_factory=list[Text], max_length=20)


class Busy(Refusal):
    """The user is in the middle of something."""


class TooLarge(Refusal):
    """The scene is too large to be copied in time."""


_REFUSALS: dict[str, type[Refusal]] = {"": Refusal, "busy": Busy, "large": TooLarge}


class _Occupied(Refusal):
    """Another client is connected."""


class AttachedBlender:
    """The open Blender that is ``wanted``, connected to with the first call; for one thread at a time.

    ``tell`` gets lines for the user. ``copy_to``: where a copy goes before the first change.
    """

    def __init__(
        self, wanted: str, client: str, copy_to: Callable[[About], str], tell: Callable[[str], object]
    ) -> None:
        self._wanted, self._client, self._copy_to, self._tell = wanted, client, copy_to, tell
        self._link: Any = None
        self._about: About | None = None
        self._copied = (0, 0)  # the process, and the number of the file in it, of which a copy was kept
        self._copy = ""
        self._note = ""
        self._noted: set[str] = set()
        self._ending = threading.Event()

    @property
    def about(self) -> About:
        """What it is, connecting to it if need be. Raises Refusal."""
        self._connected()
        assert self._about is not None
        return self._about

    # What tools need

    def call(  # noqa: PLR0913 - as of a worker
        self,
        tool: str,
        arguments: dict[str, Any],
        read: Reader[T],
        *,
        timeout: float,
        what: str = "",
        changes: bool = False,
        after: str = "",
        progress: Progress | None = None,
        cancelled: threading.Event | None = None,
        stops: bool = False,
        **_of_workers: Any,
    ) -> WorkerReply[T]:
        """Runs a tool in the open Blender; see ``Supervisor.call``. ``after`` names the undo step.

        ``stops``: the tool works in slices, and ends when it is cancelled. Raises BlenderError.
        """
        if changes:
            self.keep_copy()
            arguments = {**arguments, "step": after.removeprefix("after ") or tool}
        answer = self._ask(tool, arguments, what or tool, timeout, progress, cancelled, stops=stops)
        for event in answer.events:
            self.add_note(event)
        if answer.missing is not None:
            raise MissingModule(answer.missing)
        if answer.refused is not None:
            raise _REFUSALS[answer.kind](answer.refused)
        if answer.failed is not None:
            raise ToolBroke(answer.failed, answer.traceback)
        try:
            value = parse_value(read, answer.value)
        except Malformed as error:
            raise ToolBroke(f"The open Blender's reply to {what or tool} is not valid: {error}") from error
        return WorkerReply(value, answer.stdout, "", answer.seconds)

    def take_note(self) -> str:
        """What happened to Blender that no reply has mentioned yet; "" for nothing."""
        note, self._note = self._note, ""
        return note

    def note_once(self, note: str) -> None:
        """Puts a note before the next reply, unless it stood before an earlier one."""
        if note not in self._noted:
            self._noted.add(note)
            self.add_note(note)

    def add_note(self, note: str) -> None:
        """Puts a note before the next reply."""
        self._note = f"{self._note} {note}".strip()[-_LONGEST_NOTE:]

    def keep_copy(self) -> None:
        """Keeps a copy of the file as the user has it, before the first change of a session to it. Raises BlenderError.

        There is none of a file that is too large. If it fails otherwise, so does the change: the next one tries again.
        """
        about = self.about
        opened = self.call("opened", {}, int, timeout=60.0).value
        if self._copied == (about.process, opened):
            return
        path = self._copy_to(about)
        try:
            reply = self.call("write_copy", {"path": path, "seconds": _COPY_SECONDS}, dict, timeout=60.0)
        except TooLarge as error:
            self.add_note(f"No copy was kept before this first change: {error}")
        else:
            self._copy = path
            self.add_note(f"Before this first change, a copy was kept: {path} ({reply.seconds:.2f} s).")
        self._copied = about.process, opened

    def end(self) -> None:
        """From any thread: a running call ends soon, and no other begins."""
        self._ending.set()

    def close(self) -> None:
        """Leaves; Blender stays as it is."""
        self._ending.set()
        self._disconnect()

    # The connection

    def _disconnect(self) -> None:
        if self._link is not None:
            self._link.close()
            self._link = None

    def _connected(self) -> Any:
        if self._ending.is_set():
            raise Refusal("This session has ended.")
        if self._link is not None and (fault := self._ended()):
            raise Refusal(fault)
        if self._link is None:
            blender = choose(self._wanted)
            self._link = self._admitted(blender)
            self._tell(f"Attached to {self._about}")
            self.add_note(f"Attached to the user's open {self._about}.")
        return self._link

    def _admitted(self, blender: OpenBlender) -> Any:
        """A connection, once a client that is just leaving has left. Raises Refusal."""
        deadline = None  # from Blender's first answer on: before that, it may be busy
        while True:
            try:
                return self._met(blender)
            except _Occupied:
                deadline = deadline or time.monotonic() + _LEAVING_SECONDS
                if time.monotonic() > deadline:
                    raise
                time.sleep(_CHECK_SECONDS)

    def _met(self, blender: OpenBlender) -> Any:
        """A connection to it. Raises Refusal."""
        sock = None
        try:
            sock = socket.create_connection(("127.0.0.1", blender.port), timeout=link.MEET_SECONDS)
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            end = link.Link(sock, blender.token)
            end.send({"hello": {"name": self._client, "protocol": link.PROTOCOL}})
            first = end.receive()
        except (OSError, EOFError, channel.ForgedFrame) as error:
            if sock is not None:
                sock.close()
            raise Refusal(
                f"{blender.about} does not answer ({type(error).__name__}). If it is busy, call again when it is done; "
                "else ask the user to press Stop and Start in the panel SimWorlds, then call again."
            ) from error
        if "refused" in first:
            end.close()
            raise _Occupied(
                f"{first['refused']} Ask the user to disconnect it, or to allow several clients in the panel SimWorlds."
            )
        try:
            self._about = About.model_validate(first["welcome"])
        except (KeyError, ValidationError) as error:
            end.close()
            raise Refusal(
                "The extension in Blender is of another version: simworlds extension install."
            ) from error
        return end

    def _ended(self) -> str:
        """Why the connection has ended since the last call; "" if it has not."""
        try:
            self._link.timeout(0.0)
            while True:
                message = self._link.receive()
                if "goodbye" in message:
                    return self._lost(str(message["goodbye"])[:300])
        except (BlockingIOError, TimeoutError):
            return ""
        except (OSError, EOFError, channel.ForgedFrame):
            return self._lost("")

    def _lost(self, why: str, call: str = "Nothing of this call was done.") -> str:
        """Disconnects; in words what happened, what is known of the call, and what can be done."""
        was = self._about
        self._disconnect()
        said = why or f"{was} has ended: it crashed or was killed."
        copy = f" A copy from before the first change is {self._copy}." if self._copy else ""
        recover = "" if why else " Blender's own copy may be opened with File > Recover."
        return (
            f"{said}{copy}{recover} {call} When Blender is open again, with Start pressed in "
            "its panel SimWorlds, call again: the connection is then made anew. Read the scene's state first."
        )

    def _ask(  # noqa: PLR0913, PLR0917 - as of a call
        self,
        tool: str,
        arguments: dict[str, Any],
        what: str,
        timeout: float,
        progress: Progress | None,
        cancelled: threading.Event | None,
        *,
        stops: bool,
    ) -> _OpenAnswer:
        """The answer to a call. Raises Refusal."""
        end = self._connected()
        ticket, begun = secrets.token_hex(8), time.monotonic()
        deadline = begun + timeout + (_STOP_SECONDS if stops else _GRACE_SECONDS)
        try:
            end.timeout(_SEND_SECONDS)
            end.send({"ticket": ticket, "tool": tool, "arguments": arguments, "seconds": timeout})
            end.timeout(_CHECK_SECONDS)
            while True:
                if stops and cancelled is not None and cancelled.is_set():
                    end.timeout(_SEND_SECONDS)
                    end.send({"withdraw": ticket})  # and wait for what becomes of it
                    end.timeout(_CHECK_SECONDS)
                    deadline, cancelled = time.monotonic() + _STOP_SECONDS, None
                if (
                    time.monotonic() > deadline
                    or self._ending.is_set()
                    or (cancelled is not None and cancelled.is_set())
                ):
                    return self._give_up(end, ticket, what, time.monotonic() - begun, cancelled)
                try:
                    message = end.receive()
                except TimeoutError:
                    continue
                if "goodbye" in message:
                    raise Refusal(self._lost_during(what, str(message["goodbye"])[:300]))
                if message.get("ticket") != ticket:
                    continue  # of a call that was given up
                if "progress" in message:
                    claim = parse_message(message)
                    assert isinstance(claim, ProgressMessage)
                    if progress is not None:
                        progress(*claim.progress)
                    continue
                return _OpenAnswer.model_validate(message)
        except channel.TooLarge as error:
            raise Refusal(f"The arguments of {what} are too large: {error}.") from error
        except (OSError, EOFError) as error:
            raise Refusal(self._lost_during(what, "")) from error
        except (channel.ForgedFrame, ValidationError, Malformed) as error:
            self._disconnect()
            raise Refusal(
                f"During {what}, the open Blender sent what is not a valid reply; the connection was ended. Call again."
            ) from error

    def _give_up(
        self, end: Any, ticket: str, what: str, waited: float, cancelled: threading.Event | None
    ) -> _OpenAnswer:
        end.timeout(_SEND_SECONDS)
        end.send({"withdraw": ticket})
        if cancelled is not None and cancelled.is_set():
            raise Refusal(f"{what} was cancelled. If it had begun, it goes on to its end as one undo step.")
        raise Refusal(
            f"The open Blender has not answered {what} in {waited:.0f} s. It was withdrawn; if it had "
            "begun, it goes on to its end as one undo step. Ask the user whether Blender responds, and read the state."
        )

    def _lost_during(self, what: str, why: str) -> str:
        return self._lost(why, f"Whether {what} was done is not known.")
