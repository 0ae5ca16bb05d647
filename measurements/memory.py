"""Memory of processes."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path


def resident_mb(pid: int) -> float | None:
    """The resident memory of a process in 10⁶ bytes; None if unknown."""
    try:
        for line in Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) * 1024 / 1e6
    except OSError:
        pass
    kilobytes = _ps("-o", "rss=", "-p", str(pid)).strip()
    return int(kilobytes) * 1024 / 1e6 if kilobytes.isdigit() else None


def children() -> set[int]:
    """The ids of this process's children."""
    rows = (line.split() for line in _ps("-A", "-o", "pid=,ppid=").splitlines())
    return {int(row[0]) for row in rows if len(row) == 2 and row[1] == str(os.getpid())}


def _ps(*arguments: str) -> str:
    try:
        return subprocess.run(
            ["ps", *arguments], capture_output=True, text=True, check=False, timeout=20
        ).stdout
    except (OSError, subprocess.SubprocessError):
        return ""
