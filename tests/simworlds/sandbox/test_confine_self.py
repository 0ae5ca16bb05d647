"""Giving up rights: what a process can do after confine_self.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.system_calls import OWN_PROCESS, first_filter, installing_call, last_filter

linux = pytest.mark.skipif(sys.platform != "linux", reason="Linux confines this way")


def confined(code: str, **rights: object) -> subprocess.CompletedProcess[str]:
    machine, files = os.uname().machine, "write" in rights
    last = f"{installing_call(machine)}:{last_filter(machine, files=files).hex()}"
    calls = {"calls": first_filter(machine, files=files).hex(), "hole": OWN_PROCESS, "last": last}
    given = json.dumps({"memory": 0, "file_size": 0, **calls, **rights})
    words = [
        sys.executable,
        "-I",
        "-S",
        confine_self.__file__,
        given,
        "--",
        sys.executable,
        "-I",
        "-S",
        "-c",
        code,
    ]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


@linux
def test_exceeding_a_limit_is_an_error(tmp_path: Path) -> None:
    code = (
        "try: bytearray(1 << 30)\nexcept MemoryError: print('memory')\n"
        f"file = open({str(tmp_path / 'file')!r}, 'wb', buffering=0)\n"
        "try: [file.write(bytes(1 << 20)) for _ in range(9)]\nexcept OSError as error: print(error.strerror)"
    )
    done = confined(code, memory=300 << 20, file_size=2 << 20)
    assert done.stdout == "memory\nFile too large\n", done.stderr
    assert (tmp_path / "file").stat().st_size == 2 << 20


@linux
def test_limits_are_capped_at_the_hard_limit() -> None:
    words = (
        f"ulimit -f 8; exec {sys.executable} -I -S {confine_self.__file__} \"$1\" -- /bin/sh -c 'ulimit -f'"
    )
    rights = json.dumps({"memory": 0, "file_size": 1 << 40})
    done = subprocess.run(["sh", "-c", words, "sh", rights], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "8"


@linux
def test_capabilities_are_gone_for_good() -> None:
    done = confined("print(open('/proc/self/status').read())")
    told = dict(line.split(":\t") for line in done.stdout.splitlines() if ":\t" in line)
    assert {told[name] for name in ("CapEff", "CapPrm", "CapBnd", "CapInh", "CapAmb")} == {"0" * 16}
    assert told["NoNewPrivs"] == "1"
    assert told["Seccomp"] == "2"


@linux
@pytest.mark.skipif(not confine_self.landlock_abi(), reason="this kernel has no Landlock")
def test_a_file_that_may_be_read_cannot_be_cut_short_or_changed(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    kept.write_text("content")
    kept.chmod(0o640)
    before = kept.stat()
    code = f"""
import os
path = {str(kept)!r}
print(open(path).read())
for act in (
    lambda: os.truncate(path, 0),
    lambda: os.open(path, os.O_RDONLY | os.O_TRUNC),
    lambda: open(path, 'a'),
    lambda: os.chown(path, os.getuid(), os.getgid()),
    lambda: os.setxattr(path, 'user.x', b'1'),
    lambda: os.link(path, path + '2'),
    lambda: os.rename(path, path + '2'),
    lambda: os.unlink(path),
):
    try: act()
    except OSError: print('refused')
os.chmod(path, 0o777)
os.utime(path, (1, 1))
"""
    read = ["/usr", "/lib", "/lib64", "/proc/self", str(Path(sys.base_prefix).resolve()), str(tmp_path)]
    done = confined(code, read=[*read, sys.prefix], write=[])
    assert done.stdout.split() == ["content", *["refused"] * 8], done.stderr
    after = kept.stat()
    assert (after.st_mode, after.st_mtime, after.st_size) == (before.st_mode, before.st_mtime, before.st_size)


@linux
def test_does_not_run_unconfined(tmp_path: Path) -> None:
    done = confined("print('ran')", file_size="many")
    assert done.returncode != 0
    assert "ran" not in done.stdout
    rights = json.dumps({"memory": 0, "file_size": 0})
    missing = subprocess.run(
        [sys.executable, "-I", "-S", confine_self.__file__, rights, "--", str(tmp_path / "none")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert missing.returncode == 126
    assert "Blender cannot be confined" in missing.stderr
