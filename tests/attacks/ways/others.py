"""Ways to touch other processes: signals, tracing, memory, limits, priorities."""

from __future__ import annotations

from way import Way, way

_VECTOR = """
buffer = ctypes.create_string_buffer(target.size)
mine = struct.pack('QQ', ctypes.addressof(buffer), target.size)
theirs = struct.pack('QQ', target.address, target.size)
"""


def _call(name: str, attacks: str, code: str, **more: object) -> Way:
    return way(name, attacks, code, machine="x86_64", **more)


WAYS = (
    way("kill", "signals namespaces", "os.kill(target.pid, 15)"),
    way("kill-the-server", "signals namespaces", "os.kill(target.host, 15)"),
    way("kill-the-parent", "signals", "os.kill(os.getppid(), 9) or True", kinds=("landlock",)),
    way("kill-everybody", "signals namespaces", "os.kill(-1, 0) or True"),
    way("kill-its-group", "signals", "os.kill(0, 0) or True"),
    way("kill-a-group", "signals namespaces", "os.killpg(os.getpgid(target.pid), 0) or True"),
    _call("kill-by-tkill", "signals namespaces", "syscall(200, target.pid, 15)"),
    _call("kill-by-tgkill", "signals namespaces", "syscall(234, target.pid, target.pid, 15)"),
    _call(
        "kill-by-sigqueue",
        "signals namespaces",
        "syscall(129, target.pid, 15, struct.pack('iii', 15, 0, -1) + bytes(116))",
    ),
    _call(
        "kill-by-thread-sigqueue",
        "signals namespaces",
        "syscall(297, target.pid, target.pid, 15, struct.pack('iii', 15, 0, -1) + bytes(116))",
    ),
    way(
        "kill-by-descriptor",
        "signals namespaces",
        "import signal\nsignal.pidfd_send_signal(os.pidfd_open(target.pid), 15)",
    ),
    way(
        "kill-by-the-owner-of-a-pipe",
        "signals namespaces",
        "import fcntl\nr, w = os.pipe()\nfcntl.fcntl(r, 8, target.pid)\nfcntl.fcntl(r, 10, 15)\n"
        "fcntl.fcntl(r, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)\nos.write(w, b'x')\nTrue",
    ),
    way(
        "kill-by-the-extended-owner-of-a-pipe",
        "signals namespaces",
        "import fcntl\nr, w = os.pipe()\nfcntl.fcntl(r, 15, struct.pack('ii', 1, target.pid))\n"
        "fcntl.fcntl(r, 10, 15)\n"
        "fcntl.fcntl(r, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)\nos.write(w, b'x')\nTrue",
    ),
    way(
        "kill-by-the-owner-of-a-socket",
        "signals namespaces",
        "import fcntl\n"
        "numbers = [int(n) for n in os.listdir('/proc/self/fd') if worked(os.readlink, "
        "f'/proc/self/fd/{n}') and 'socket' in os.readlink(f'/proc/self/fd/{n}')]\n"
        "[fcntl.ioctl(n, 0x8901, struct.pack('i', target.pid)) for n in numbers] or "
        "[fcntl.fcntl(n, 8, target.pid) for n in numbers]",
        denied=("22",),
    ),
    way(
        "kill-by-limits",
        "signals limits namespaces",
        "import resource\nresource.prlimit(target.pid, resource.RLIMIT_CPU, (1, 1)) or True",
    ),
    way(
        "take-its-descriptors",
        "signals limits namespaces",
        "import resource\nresource.prlimit(target.pid, resource.RLIMIT_NOFILE, (0, 0)) or True",
    ),
    way("slow-it-down", "signals namespaces", "os.setpriority(os.PRIO_PROCESS, target.pid, 19)"),
    way("slow-all-of-the-user", "signals uid", "os.setpriority(os.PRIO_USER, 12345, 0) or True"),
    way("pin-it", "signals namespaces", "os.sched_setaffinity(target.pid, {0}) or True"),
    way(
        "reschedule-it",
        "signals namespaces",
        "os.sched_setscheduler(target.pid, os.SCHED_IDLE, os.sched_param(0)) or True",
    ),
    _call("starve-its-disk", "signals namespaces", "syscall(251, 1, target.pid, (3 << 13)) == 0"),
    way("trace-it", "signals namespaces uid", "c('ptrace', 16, target.pid, 0, 0) == 0"),
    way("seize-it", "signals namespaces uid", "c('ptrace', 0x4206, target.pid, 0, 0) == 0"),
    _call(
        "read-its-memory",
        "signals namespaces uid",
        f"{_VECTOR}syscall(310, target.pid, mine, 1, theirs, 1, 0)\nbuffer.raw",
    ),
    _call(
        "write-its-memory",
        "signals namespaces uid",
        f"{_VECTOR}syscall(311, target.pid, mine, 1, theirs, 1, 0)",
    ),
    way(
        "read-its-memory-as-a-file",
        "signals namespaces files uid",
        "file = open(f'/proc/{target.pid}/mem', 'rb', 0)\nfile.seek(target.address)\nfile.read(target.size)",
    ),
    way("read-its-maps", "signals namespaces files uid", "read(f'/proc/{target.pid}/maps')"),
    way("read-its-environment", "signals namespaces files uid", "read(f'/proc/{target.pid}/environ')"),
    _call(
        "take-its-file",
        "signals namespaces uid",
        "number = syscall(438, os.pidfd_open(target.pid), target.descriptor, 0)\nos.pread(number, 99, 0)",
    ),
    _call(
        "advise-its-memory",
        "signals namespaces uid",
        f"{_VECTOR}syscall(440, os.pidfd_open(target.pid), theirs, 1, 20, 0)",
    ),
    _call(
        "compare-its-files", "signals namespaces uid", "syscall(312, target.pid, os.getpid(), 0, 1, 1) >= 0"
    ),
    _call(
        "move-its-pages",
        "signals namespaces uid",
        "syscall(279, target.pid, 1, struct.pack('Q', target.address & ~4095), None, "
        "ctypes.create_string_buffer(8), 0) == 0",
    ),
    _call(
        "migrate-its-pages",
        "signals namespaces uid",
        "syscall(256, target.pid, 64, ctypes.byref(ctypes.c_ulong(1)), ctypes.byref(ctypes.c_ulong(1))) >= 0",
    ),
    _call(
        "watch-it",
        "signals kernel namespaces uid",
        "syscall(298, struct.pack('IIQ', 1, 112, 1) + bytes(96), target.pid, -1, -1, 0)",
        denied=("95",),
    ),
    _call(
        "find-its-locks",
        "signals namespaces uid",
        "where, size = ctypes.c_ulong(), ctypes.c_ulong()\n"
        "syscall(274, target.pid, ctypes.byref(where), ctypes.byref(size)) == 0",
    ),
    way(
        "enter-its-namespaces",
        "processes capabilities files uid signals",
        "c('setns', os.open(f'/proc/{target.pid}/ns/mnt', 0), 0) == 0",
    ),
    _call(
        "enter-its-namespaces-by-descriptor",
        "processes capabilities namespaces uid signals",
        "syscall(308, os.pidfd_open(target.pid), 0x20000000) == 0",
    ),
    _call(
        "kill-for-memory",
        "signals namespaces",
        "syscall(448, os.pidfd_open(target.pid), 0) == 0",
        denied=("22",),
    ),
    way("type-into-a-terminal", "signals", "import fcntl\nfcntl.ioctl(0, 0x5412, b'x')", denied=("25",)),
    way(
        "see-that-it-is-there",
        "namespaces",
        "os.path.exists(f'/proc/{target.pid}/stat')",
        kinds=("bubblewrap",),
    ),
    way("outlive-the-server", "signals", "c('prctl', 1, 0, 0, 0, 0) == 0"),
    way("be-traced-by-others", "signals", "c('prctl', 4, 0, 0, 0, 0) == 0"),
    way("be-traced-by-anybody", "signals", "c('prctl', 0x59616d61, -1, 0, 0, 0) == 0", denied=("22",)),
)
