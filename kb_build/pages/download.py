"""Downloads an archive; resumes broken downloads and gives up on silent hosts."""

from __future__ import annotations

import json
import queue
import threading
import time
import zipfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from kb_build.errors import SourceError
from simworlds.errors import remedy

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import httpx2

    from kb_build.pages.archives import Progress

_CHUNK = 1 << 16
_STALL_SECONDS = 15.0
_ATTEMPTS = 5
_Event = tuple[int, int | None] | Exception | None


@dataclass(slots=True)
class DownloadPatience:
    """The seconds left to wait for hosts that do not answer, all of them together."""

    seconds: float = 10.0
    silent_hosts: dict[str, str] = field(default_factory=dict[str, str])

    def spend(self, seconds: float, host: str, fault: str) -> None:
        """Records that ``host`` was silent for ``seconds``; it is not asked again."""
        self.seconds = max(0.0, self.seconds - seconds)
        self.silent_hosts[host] = fault


@dataclass(frozen=True, slots=True)
class ArchiveKind:
    """What a download must be: its name in messages, how it is recognised, and the most bytes that it may have."""

    name: str
    recognise: Callable[[Path], bool]
    largest: int


ZIP = ArchiveKind("zip archive", zipfile.is_zipfile, 2 << 30)


def download(
    url: str,
    target: Path,
    *,
    patience: DownloadPatience,
    progress: Progress | None = None,
    kind: ArchiveKind = ZIP,
) -> None:
    """Fetch the archive at ``url`` into ``target``.

    What has arrived stays in ``target``'s .part file when the transfer breaks off, and the next call goes on
    from there, provided the server still has the same file. Raises SourceError with address and fault.
    """
    host = urlsplit(url).netloc
    if host in patience.silent_hosts:
        raise SourceError(
            f"{url} was not tried: {host} did not answer before ({patience.silent_hosts[host]})"
        )
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(target.name + ".part")
    for attempts_left in reversed(range(_ATTEMPTS)):
        before = _size(part)
        try:
            _Transfer(url, part, patience, progress, kind.largest).run(f"downloading {target.name}")
            break
        except _BrokeOffError as error:
            if not attempts_left or _size(part) <= before:
                raise SourceError(
                    f"{url} broke off after {_size(part):,} bytes ({error}); run again to go on from there"
                ) from error
    _accept(url, part, target, kind)


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


def _accept(url: str, part: Path, target: Path, kind: ArchiveKind) -> None:
    if not kind.recognise(part):
        with part.open("rb") as file:
            start = file.read(40)
        part.unlink()
        raise SourceError(f"{url} is not a {kind.name} (it starts with {start!r})")
    part.replace(target)
    _validator_file(part).unlink(missing_ok=True)


def _validator_file(part: Path) -> Path:
    """Where it is noted which file of the server's the .part file is the beginning of."""
    return part.with_name(part.name + ".json")


class _BrokeOffError(Exception):
    """The connection ended before the file did."""


@dataclass(slots=True)
class _Transfer:
    """One request. The connection lives in a thread of its own: looking up a name cannot be timed out."""

    url: str
    part: Path
    patience: DownloadPatience
    progress: Progress | None
    largest: int
    events: queue.SimpleQueue[_Event] = field(default_factory=queue.SimpleQueue[_Event])
    writing: threading.Lock = field(default_factory=threading.Lock)
    stopped: bool = False

    def run(self, label: str) -> None:
        """Bring ``part`` to its full length; raises _BrokeOffError where trying again may help."""
        started, answered = time.monotonic(), False
        threading.Thread(target=self._work, daemon=True).start()
        try:
            while (event := self._next_event(answered, started)) is not None:
                if isinstance(event, Exception):
                    raise event
                answered = True
                if self.progress:
                    self.progress(label, *event)
        except _BrokeOffError as error:
            if answered:
                raise
            self.patience.spend(time.monotonic() - started, urlsplit(self.url).netloc, str(error))
            raise SourceError(f"{self.url} could not be reached ({error})") from error
        finally:
            with self.writing:  # from here on the thread leaves the file alone, whenever it wakes up
                self.stopped = True

    def _next_event(self, answered: bool, started: float) -> _Event:
        wait = _STALL_SECONDS if answered else started + self.patience.seconds - time.monotonic()
        try:
            return self.events.get(timeout=max(0.0, wait))
        except queue.Empty:
            raise _BrokeOffError(f"nothing came for {time.monotonic() - started:.0f} s") from None

    def _work(self) -> None:
        import httpx2  # noqa: PLC0415 - a tenth of a second to load, and most builds download nothing

        try:
            self._request()
            self.events.put(None)
        except httpx2.HTTPStatusError as error:
            self._fail(f"answered with {error.response.status_code} {error.response.reason_phrase}", error)
        except httpx2.TooManyRedirects as error:
            self._fail("redirects in a circle", error)
        except httpx2.RequestError as error:
            self.events.put(_BrokeOffError(str(error) or type(error).__name__))
        except OSError as error:
            self._fail(f"could not be stored in {self.part.parent} ({error}). {remedy(error)}", error)
        except Exception as error:  # a thread's fault must not be lost: the caller waits for it
            self._fail(f"could not be fetched ({error})", error)

    def _fail(self, fault: str, cause: Exception) -> None:
        error = SourceError(f"{self.url} {fault}")
        error.__cause__ = cause
        self.events.put(error)

    def _request(self) -> None:
        import httpx2  # noqa: PLC0415 - likewise

        timeout = httpx2.Timeout(_STALL_SECONDS, connect=max(0.1, self.patience.seconds))
        offset, headers = self._resume_headers()
        with (
            httpx2.Client(timeout=timeout, follow_redirects=True, max_redirects=5) as client,
            client.stream("GET", self.url, headers=headers) as response,
        ):
            if response.status_code == 416 and offset:
                self.part.unlink()  # as long as the file or longer: whole, or not its beginning
                return self._request()
            response.raise_for_status()
            if self.url.startswith("https:") and response.url.scheme != "https":
                raise ValueError(f"it redirects to {response.url}, which is not encrypted")
            if response.status_code != 206:
                offset = 0
            elif not response.headers.get("Content-Range", "").startswith(f"bytes {offset}-"):
                raise ValueError("it answers with another part of the file than it was asked for")
            return self._receive(response, offset)

    def _resume_headers(self) -> tuple[int, dict[str, str]]:
        headers = {"Accept-Encoding": "identity", "User-Agent": "simworlds"}
        offset, known = _size(self.part), _read_json(_validator_file(self.part))
        if not offset or known.get("url") != self.url or not known.get("validator"):
            return 0, headers
        return offset, headers | {"Range": f"bytes={offset}-", "If-Range": str(known["validator"])}

    def _receive(self, response: httpx2.Response, offset: int) -> None:
        length = response.headers.get("Content-Length", "")
        total = offset + int(length) if length.isdigit() else None
        if (total or 0) > self.largest:
            raise ValueError(f"it would be {total:,} bytes, more than such a file has")
        with self.part.open("ab" if offset else "wb") as file:
            if not offset:  # of another file nothing may be left once this one's validator is noted
                note = {"url": self.url, "validator": _validator(response)}
                _validator_file(self.part).write_text(json.dumps(note), encoding="utf-8")
            for chunk in response.iter_raw(_CHUNK):
                with self.writing:
                    if self.stopped:
                        return
                    file.write(chunk)
                    file.flush()
                offset += len(chunk)
                if offset > self.largest:
                    raise ValueError(f"it is longer than {self.largest:,} bytes, more than such a file has")
                self.events.put((offset, total))


def _validator(response: httpx2.Response) -> str:
    """The validator of the file's state: a strong ETag, else its date; empty if there is neither."""
    etag = response.headers.get("ETag", "")
    return etag if etag.startswith('"') else response.headers.get("Last-Modified", "")


def _read_json(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
