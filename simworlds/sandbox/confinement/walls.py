"""The walls of a sandbox by name: what each keeps executed code from."""

from __future__ import annotations

from typing import Literal, get_args

Wall = Literal[
    "files",
    "proc",
    "uid",
    "capabilities",
    "namespaces",
    "sockets",
    "processes",
    "signals",
    "memfd",
    "attributes",
    "kernel",
    "limits",
    "memory",
    "disk",
    "environment",
]

WALLS: tuple[Wall, ...] = get_args(Wall)
EVERY_WALL: frozenset[Wall] = frozenset(WALLS)

WITHOUT: dict[Wall, str] = {
    "files": "reading and writing any file that you can",
    "proc": "changing the kernel's settings and its own place among those killed for memory",
    "uid": "acting as root towards the kernel",
    "capabilities": "keeping capabilities",
    "namespaces": "seeing other processes and sharing their network, names and memory segments",
    "sockets": "opening sockets",
    "processes": "starting processes and programs",
    "signals": "signalling and tracing other processes",
    "memfd": "files in memory",
    "attributes": "reading extended attributes and the targets of links outside",
    "kernel": "rarely used parts of the kernel: bpf, perf, io_uring, userfaultfd, keys, fanotify, mounts",
    "limits": "changing its own limits, and files beyond their limit",
    "memory": "taking more memory than its limit by sharing it between mappings",
    "disk": "filling the disk",
    "environment": "seeing your environment's secrets",
}
"""What code can do where a wall is down, in words that follow "does not prevent"."""
