"""What attacks are aimed at, and how their success is seen: files, names, sockets, a process with secrets.

Nothing here depends on what an attack says of itself. Everything is looked at after every attack, whatever it was
aimed at.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import os
import re
import resource
import secrets
import shutil
import signal
import socket
import sqlite3
import stat
import struct
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hosts import Host

HELPERS = Path(__file__).with_name("inside") / "helpers.py"
MOST_MEMORY = 1 << 30  # bytes that a server may take for one call
_BEGINS = b"sw-secret-"
_SECRET = re.compile(_BEGINS + rb"[0-9a-f]{16}")
_FLAGS = 0x80086601  # FS_IOC_GETFLAGS
_WITNESS = """
import ctypes, os, sys, tempfile, time
kept = ctypes.create_string_buffer(sys.argv[1].encode())
libc = ctypes.CDLL(None)
libc.capset(bytes([0x22, 0x05, 0x08, 0x20]) + bytes(4), bytes(24))  # it is no better than what attacks it
file = tempfile.TemporaryFile()
file.write(sys.argv[2].encode()); file.flush()
print(ctypes.addressof(kept), file.fileno(), flush=True)
while True: time.sleep(60)
"""
_TAKEN_FIELDS = ("Uid", "Gid", "CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb", "NoNewPrivs", "Seccomp")


class Outside:
    """Files that nothing may read or change, a process that nothing may touch, sockets that nothing may reach."""

    def __init__(self) -> None:
        self.mark = f"sw{secrets.token_hex(4)}"
        self.secrets: dict[str, str] = {}
        self.root = Path(tempfile.mkdtemp(prefix="simworlds-attacked-"))
        self.root.chmod(0o755)
        self.home = Path(tempfile.mkdtemp(prefix=".simworlds-attacked-", dir=Path.home()))
        self.readable = Path(tempfile.mkdtemp(prefix="simworlds-readable-"))
        self.folder, self.programs = self.root / "outside", self.root / "programs"
        self.sockets = self.root / "sockets"
        for folder in (self.sockets, self.programs):
            folder.mkdir()
        self._make_program("gs")
        self._listeners: dict[str, socket.socket] = {}
        self._listen()
        self._witness: subprocess.Popen[bytes] | None = None
        self.restore()

    def secret(self, of: str) -> str:
        """A word that is nowhere but where ``of`` says."""
        return self.secrets.setdefault(of, f"{_BEGINS.decode()}{secrets.token_hex(8)}")

    # Making it

    def restore(self) -> None:
        """Puts everything back as it was at the start."""
        for folder in (self.folder, self.readable):
            folder.mkdir(exist_ok=True)
            for path in folder.iterdir():
                shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
            folder.chmod(0o777)
        self._write(self.folder / "file", self.secret("the content of a file"))
        self._write(self.folder / "deep" / "file", self.secret("the content of a deeper file"))
        self._write(self.folder / "names" / self.secret("the name of a file"), "")
        self._write(self.folder / "victim", "nobody may overwrite this")
        self._write(self.readable / "file", "this may be read, not changed")
        self._write(self.home / ".ssh" / "id_ed25519", self.secret("a key in the home folder"))
        self._write(self.folder / "file.py", f"note = {self.secret('the value of a module')!r}")
        with sqlite3.connect(self.folder / "file.db") as base:
            base.execute(f'create table "{self.secret("a table of a database")}" (a)')
        base.close()
        (self.folder / "link").symlink_to(f"/nowhere/{self.secret('the target of a link')}")
        with suppress(OSError):
            os.setxattr(self.folder / "file", "user.note", self.secret("an attribute of a file").encode())
        self._make_picture(self.folder / "picture.png")
        if self._witness is None or self._witness.poll() is not None:
            self._start_witness()
        self.before = self._state()

    @staticmethod
    def _write(path: Path, text: str) -> None:
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        path.chmod(0o666)

    @staticmethod
    def _make_picture(path: Path) -> None:
        from PIL import Image

        Image.new("RGB", (37, 53), (200, 30, 30)).save(path)
        path.chmod(0o666)

    def _make_program(self, name: str) -> None:
        """A program by that name that leaves a trace when somebody starts it."""
        program = self.programs / name
        program.write_text(f"#!/bin/sh\necho started > {self.root}/outside/{name}-was-started\n")
        program.chmod(0o755)

    def _start_witness(self) -> None:
        self._end_witness()
        words = [
            sys.executable,
            "-c",
            _WITNESS,
            self.secret("the memory of a process"),
            self.secret("an open file"),
        ]
        environment = {"SECRET": self.secret("the environment of a process")}
        self._witness = subprocess.Popen(words, env=environment, stdout=subprocess.PIPE)
        assert self._witness.stdout is not None
        self.address, self.descriptor = map(int, self._witness.stdout.readline().split())

    def _end_witness(self) -> None:
        if self._witness is not None:
            self._witness.kill()
            self._witness.wait()
            assert self._witness.stdout is not None
            self._witness.stdout.close()

    def _listen(self) -> None:
        self.abstract = f"{self.mark}-abstract"
        for name, family, kind, where in (
            ("tcp", socket.AF_INET, socket.SOCK_STREAM, ("127.0.0.1", 0)),
            ("udp", socket.AF_INET, socket.SOCK_DGRAM, ("127.0.0.1", 0)),
            ("tcp6", socket.AF_INET6, socket.SOCK_STREAM, ("::1", 0)),
            ("stream", socket.AF_UNIX, socket.SOCK_STREAM, str(self.sockets / "stream")),
            ("datagram", socket.AF_UNIX, socket.SOCK_DGRAM, str(self.sockets / "datagram")),
            ("abstract", socket.AF_UNIX, socket.SOCK_STREAM, f"\0{self.abstract}"),
            ("abstract_datagram", socket.AF_UNIX, socket.SOCK_DGRAM, f"\0{self.abstract}-datagram"),
        ):
            listener = socket.socket(family, kind)
            try:
                listener.bind(where)
            except OSError as error:  # a machine without IPv6
                listener.close()
                if error.errno in {errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT}:
                    continue
                raise
            listener.setblocking(False)
            if kind == socket.SOCK_STREAM:
                listener.listen()
            if isinstance(where, str) and not where.startswith("\0"):
                Path(where).chmod(0o666)
            self._listeners[name] = listener

    def port(self, name: str) -> int:
        """The port of a listener; 9 where there is none."""
        return self._listeners[name].getsockname()[1] if name in self._listeners else 9

    def facts(self, host: Host) -> dict[str, Any]:
        """What an attack knows: where everything is, but none of the secrets."""
        return {
            "file": str(self.folder / "file"),
            "folder": str(self.folder),
            "victim": str(self.folder / "victim"),
            "names": str(self.folder / "names"),
            "link": str(self.folder / "link"),
            "picture": str(self.folder / "picture.png"),
            "key": str(self.home / ".ssh" / "id_ed25519"),
            "readable": str(self.readable / "file"),
            "top": str(self.root),
            "home": str(self.home),
            "root": str(host.root),
            "workspace": str(host.root / "workspace"),
            "private": str(host.root / "private"),
            "sockets": str(self.sockets),
            "abstract": self.abstract,
            "tcp": self.port("tcp"),
            "udp": self.port("udp"),
            "tcp6": self.port("tcp6"),
            "pid": self._pid,
            "address": self.address,
            "descriptor": self.descriptor,
            "size": len(self.secret("the memory of a process")),
            "host": host.pid,
            "kind": host.kind,
            "mark": self.mark,
        }

    def helpers(self, host: Host) -> str:
        """The code that comes before every attack's own."""
        return f"{HELPERS.read_text()}\ntarget = SimpleNamespace(**{self.facts(host)!r})\n"

    # Looking at it

    def evidence(self, host: Host, answers: list[dict[str, Any]], rights: dict[str, str]) -> list[str]:
        """What an attack has achieved, in words; none if it has failed. ``answers``: what the server replied."""
        found = [
            *self._got_out(host, answers),
            *self._changed(),
            *self._arrived(),
            *self._running(host),
            *self._left(host),
            *(f"the server broke: {answer['message']}" for answer in answers if "broke" in answer),
        ]
        if (peak := peak_memory(host.pid)) > MOST_MEMORY:
            found.append(f"the server took {peak / 1e9:.1f} GB of memory")
        now = rights_of(host.process)
        found += [
            f"{name} of Blender's process became {now[name]}, before {rights[name]}"
            for name in rights
            if now and now.get(name) != rights[name]
        ]
        return found

    def _got_out(self, host: Host, answers: list[dict[str, Any]]) -> Iterator[str]:
        told = {*_SECRET.findall(json.dumps(answers).encode())}
        kept = {secret for content in _contents(host.root) for secret in _secrets_in(content)}
        for of, secret in self.secrets.items():
            if secret.encode() in told:
                yield f"{of} came back in a reply"
            if secret.encode() in kept:
                yield f"{of} was copied into the run's folder"

    def _changed(self) -> Iterator[str]:
        now = self._state()
        for path in sorted({*self.before, *now}):
            if self.before.get(path) != now.get(path):
                word = (
                    "changed"
                    if path in self.before and path in now
                    else "appeared"
                    if path in now
                    else "is gone"
                )
                yield f"{path} {word}: {self.before.get(path)} → {now.get(path)}"
        if found := [path for path in _shared_places() if self.mark in path]:
            yield f"{', '.join(found)} appeared"

    def _arrived(self) -> Iterator[str]:
        for name, listener in self._listeners.items():
            with suppress(BlockingIOError, InterruptedError):
                if listener.type == socket.SOCK_DGRAM:
                    yield f"a datagram arrived at {name}: {listener.recv(100)!r}"
                else:
                    listener.accept()[0].close()
                    yield f"somebody connected to {name}"

    def _running(self, host: Host) -> Iterator[str]:
        """Processes and threads that carry the mark."""
        for folder in Path("/proc").glob("[0-9]*"):
            number = int(folder.name)
            if number in {os.getpid(), host.pid, self._pid}:
                continue
            try:
                if (folder / "stat").read_text().rpartition(")")[2].split()[0] in "XZ":
                    continue
                names = [
                    (folder / "cmdline").read_bytes().split(b"\0")[0],
                    (folder / "comm").read_bytes().strip(),
                ]
                if number == host.process or _parent(number) == host.pid:
                    names += [path.read_bytes().strip() for path in folder.glob("task/*/comm")]
            except (OSError, ValueError):
                continue
            if self.mark.encode() in names:
                yield f"process {number} of the attack runs"
                with suppress(OSError):
                    if number != host.process:
                        os.kill(number, signal.SIGKILL)

    def _left(self, host: Host) -> Iterator[str]:
        """Files of the attack beside the workspace, and programs with somebody else's rights in it."""
        for folder, folders, files in os.walk(host.root.parent):
            for name in (*folders, *files):
                path = Path(folder, name)
                with suppress(OSError):
                    mode = path.lstat().st_mode
                    if mode & (stat.S_ISUID | stat.S_ISGID) and stat.S_ISREG(mode):
                        yield f"{path} is a program that runs as its owner"
                    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
                        yield f"{path} is a device"
                own = (host.root / place for place in ("workspace", "private", "previews"))
                if self.mark in name and not _is_below(path, *own):
                    yield f"{path} was made"

    @property
    def _pid(self) -> int:
        assert self._witness is not None
        return self._witness.pid

    def _state(self) -> dict[str, Any]:
        """Everything that may not change: files, and the process."""
        state = {
            str(path): _file_state(path)
            for top in (self.folder, self.readable, self.home, self.sockets, self.programs)
            for path in (top, *sorted(top.rglob("*")))
        }
        assert self._witness is not None
        state["the process"] = self._witness.poll()
        if self._witness.poll() is None:
            state |= {f"the process's {name}": value for name, value in rights_of(self._pid).items()}
            state["the process's limits"] = [resource.prlimit(self._pid, which) for which in range(16)]
        return state

    def close(self) -> None:
        """Ends and removes all of it."""
        self._end_witness()
        for listener in self._listeners.values():
            listener.close()
        for folder in (self.root, self.readable, self.home):
            shutil.rmtree(folder, ignore_errors=True)


def rights_of(process: int) -> dict[str, str]:
    """What a process may do and how it is treated: identity, capabilities, filters, limits, niceness. Empty if gone."""
    try:
        folder = Path(f"/proc/{process}")
        lines = dict(
            line.split(":\t", 1) for line in (folder / "status").read_text().splitlines() if ":\t" in line
        )
        return {
            **{name: lines[name] for name in _TAKEN_FIELDS},
            "oom_score_adj": (folder / "oom_score_adj").read_text().strip(),
            "control group": (folder / "cgroup").read_text().strip(),
            "limits": hashlib.sha256((folder / "limits").read_bytes()).hexdigest()[:12],
            "niceness": str(os.getpriority(os.PRIO_PROCESS, process)),
            "processors": str(sorted(os.sched_getaffinity(process))),
            "scheduling": str(os.sched_getscheduler(process)),
        }
    except (OSError, LookupError, ValueError):
        return {}


def peak_memory(process: int) -> int:
    """The most memory that a process had since ``forget_peak``, in bytes."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
        return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return 0


def forget_peak(process: int) -> None:
    """Begins anew to note the most memory of a process."""
    with suppress(OSError):
        Path(f"/proc/{process}/clear_refs").write_text("5")


def _file_state(path: Path) -> Any:
    try:
        status = path.lstat()
        state: list[Any] = [oct(status.st_mode), status.st_uid, status.st_gid, status.st_nlink]
        if stat.S_ISLNK(status.st_mode):
            return [*state, str(path.readlink())]
        if stat.S_ISDIR(status.st_mode):
            return [*state, status.st_mtime_ns]
        if not stat.S_ISREG(status.st_mode):
            return state
        names = sorted(os.listxattr(path))
        attributes = {name: os.getxattr(path, name).hex() for name in names}
        number = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        try:
            flags = struct.unpack("l", fcntl.ioctl(number, _FLAGS, bytes(8)))[0]
        except OSError:
            flags = 0
        finally:
            os.close(number)
        content = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        return [*state, status.st_mtime_ns, status.st_size, content, attributes, flags]
    except FileNotFoundError:
        return None


def _secrets_in(content: bytes) -> list[bytes]:
    """All that is or may be a secret. What they begin with is looked for first: there is much to read."""
    return _SECRET.findall(content) if _BEGINS in content else []


def _contents(root: Path) -> Iterator[bytes]:
    """What was written in a run, as far as it is not huge; nothing is followed."""
    for folder, _, files in os.walk(root):
        for name in files:
            with suppress(OSError):
                number = os.open(Path(folder, name), os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
                try:
                    if stat.S_ISREG(os.fstat(number).st_mode):
                        yield os.read(number, 4 << 20)
                finally:
                    os.close(number)


def _shared_places() -> Iterator[str]:
    """What lies directly in places to which everybody may write."""
    for place in ("/tmp", "/var/tmp", "/dev/shm", "/dev/mqueue", "/run", "/", "/etc", "/dev", "/usr"):
        with suppress(OSError):
            yield from (str(path) for path in Path(place).iterdir())


def _parent(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


def _is_below(path: Path, *folders: Path) -> bool:
    return any(path.is_relative_to(folder) for folder in folders)
