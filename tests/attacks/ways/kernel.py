"""Ways through the kernel: rarely used system calls, its files below /proc and /sys, rights that were given up."""

from __future__ import annotations

import os
from pathlib import Path

from way import Way, way


def _call(name: str, attacks: str, code: str, **more: object) -> Way:
    return way(name, attacks, code, machine="x86_64", **more)


def _reach(name: str, attacks: str, number: int, arguments: str = "0, 0, 0, 0, 0") -> Way:
    """A system call that may not get as far as the checks of its arguments."""
    return _call(name, attacks, f"reaches({number}, {arguments})")


def _setting(path: str, attacks: str = "proc files uid") -> Way:
    """A file of the kernel, written over with what it holds."""
    name = path.strip("/").replace("/", "-").replace("_", "-")
    there = path.replace("/proc/self/", f"/proc/{os.getpid()}/")
    return way(
        f"set-{name}", attacks, f"rewrite({path!r})", denied=("22", "5"), ready=lambda: Path(there).exists()
    )


_SETTINGS = (
    "/proc/sys/kernel/core_pattern",
    "/proc/sys/kernel/modprobe",
    "/proc/sys/kernel/hostname",
    "/proc/sys/kernel/domainname",
    "/proc/sys/kernel/randomize_va_space",
    "/proc/sys/kernel/shmmax",
    "/proc/sys/kernel/msgmax",
    "/proc/sys/fs/file-max",
    "/proc/sys/fs/suid_dumpable",
    "/proc/sys/fs/mqueue/msg_max",
    "/proc/sys/net/ipv4/ip_forward",
    "/proc/sys/user/max_user_namespaces",
    "/proc/sys/vm/overcommit_memory",
    "/proc/sys/vm/drop_caches",
    "/sys/kernel/uevent_helper",
    "/sys/kernel/mm/transparent_hugepage/enabled",
    "/sys/module/kernel/parameters/panic",
    "/sys/power/disk",
)

WAYS = (
    *map(_setting, _SETTINGS),
    way("set-the-place-among-the-killed", "proc files", "open('/proc/self/oom_score_adj', 'w').write('0')"),
    way(
        "set-the-place-among-the-killed-through-a-thread",
        "proc files",
        "open(f'/proc/thread-self/oom_score_adj', 'w').write('0')",
    ),
    way("set-the-old-place-among-the-killed", "proc files", "open('/proc/self/oom_adj', 'w').write('0')"),
    way(
        "set-the-filter-of-core-dumps", "proc files", "open('/proc/self/coredump_filter', 'w').write('0xff')"
    ),
    way("set-the-login", "proc files", "open('/proc/self/loginuid', 'w').write('0')"),
    way("set-the-label", "proc files", "open('/proc/self/attr/current', 'w').write('x')", denied=("22",)),
    way("press-a-magic-key", "proc files", "open('/proc/sysrq-trigger', 'w').write(' ')"),
    way(
        "register-a-format-of-programs",
        "proc files",
        "open('/proc/sys/fs/binfmt_misc/register', 'w').write(':x')",
    ),
    way(
        "move-an-interrupt",
        "proc files",
        "import glob\n"
        "[worked(rewrite, path) for path in glob.glob('/proc/irq/*/smp_affinity')[:1] if "
        "worked(rewrite, path)]",
        denied=("5",),
    ),
    way(
        "leave-its-control-group",
        "files memory",
        "import glob\n[path for path in [*glob.glob('/sys/fs/cgroup/*/cgroup.procs'), "
        "'/sys/fs/cgroup/cgroup.procs']\n"
        " if os.path.exists(path) and worked(lambda: open(path, 'a').write(str(os.getpid())))]",
        denied=("22", "16"),
    ),
    way(
        "loosen-its-control-group",
        "files memory",
        "import glob\n[path for path in glob.glob('/sys/fs/cgroup/**/memory.max', recursive=True)[:5]\n"
        " + glob.glob('/sys/fs/cgroup/**/memory.limit_in_bytes', recursive=True)[:5] if "
        "worked(rewrite, path)]",
        denied=("22", "16"),
    ),
    way(
        "be-told-when-a-control-group-empties",
        "files capabilities uid",
        "[path for path in ['/sys/fs/cgroup/memory/release_agent', "
        "'/sys/fs/cgroup/cpu/release_agent'] if os.path.exists(path) and worked(rewrite, path)]",
    ),
    # Calls.
    _reach("load-a-program-into-the-kernel", "kernel", 321, "0, bytes(128), 128"),
    _call(
        "count-events",
        "kernel",
        "syscall(298, struct.pack('IIQ', 1, 112, 1) + bytes(24) + struct.pack('Q', 0x61) + "
        "bytes(64), 0, -1, -1, 0)",
    ),
    _call("handle-its-own-faults", "kernel", "syscall(323, 1)"),
    _call("ring-the-kernel", "kernel", "syscall(425, 8, ctypes.create_string_buffer(120))"),
    _reach("enter-a-ring", "kernel", 426, "-1, 0, 0, 0, 0"),
    _reach("register-with-a-ring", "kernel", 427, "-1, 0, 0, 0"),
    _call("add-a-key", "kernel", "syscall(248, b'user', target.mark.encode(), b'payload', 7, -2)"),
    _call("ask-for-a-key", "kernel", "syscall(249, b'user', target.mark.encode(), 0, -2)", denied=("126",)),
    _call("read-a-key", "kernel", "syscall(250, 0, -4, 1)"),
    _reach("a-file-system-of-its-own", "kernel capabilities uid", 430, "b'tmpfs', 0"),
    _call(
        "a-mount-of-its-own", "kernel capabilities uid", "c('mount', b'none', b'.', b'tmpfs', 0, None) == 0"
    ),
    _call(
        "a-mount-of-everything", "kernel capabilities uid", "c('mount', b'/', b'.', None, 4096, None) == 0"
    ),
    _call(
        "a-mount-made-writable",
        "kernel capabilities uid",
        "c('mount', None, b'/', None, 32 | 4096, None) == 0",
    ),
    _call(
        "a-mount-made-writable-by-attributes",
        "kernel capabilities uid",
        "syscall(442, -100, b'/', 0, struct.pack('QQQQ', 0, 1, 0, 0), 32) == 0",
    ),
    _call("a-copy-of-a-mount", "kernel capabilities uid", "syscall(428, -100, b'/', 1)"),
    _reach("move-a-mount", "kernel capabilities uid", 429, "-1, b'', -100, b'.', 4"),
    _call("uncover-what-lies-below-a-mount", "kernel capabilities uid", "c('umount2', b'/proc', 2) == 0"),
    _call("another-root", "kernel capabilities uid", "c('chroot', b'.') == 0"),
    _call(
        "exchange-the-root",
        "kernel capabilities uid",
        "c('pivot_root', b'.', b'.') == 0",
        denied=("16", "22"),
    ),
    _call("a-user-namespace", "processes namespaces kernel", "c('unshare', 0x10000000) == 0"),
    _call("a-mount-namespace", "processes capabilities kernel uid", "c('unshare', 0x20000) == 0"),
    _call("a-network-namespace", "processes capabilities kernel uid", "c('unshare', 0x40000000) == 0"),
    _call("a-time-namespace", "processes capabilities kernel uid", "c('unshare', 0x80) == 0"),
    _call(
        "a-user-namespace-for-a-thread",
        "processes namespaces kernel",
        "syscall(56, 0x10000000 | 17, 0, 0, 0, 0) >= 0",
    ),
    _reach("load-a-module", "kernel capabilities uid", 175, "b'', 0, b''"),
    _reach("load-a-module-by-descriptor", "kernel capabilities uid", 313, "-1, b'', 0"),
    _reach("another-kernel", "kernel capabilities uid", 246, "0, 0, 0, 0x10000"),
    _reach("another-kernel-by-descriptor", "kernel capabilities uid", 320, "-1, -1, 0, b'', 0"),
    _reach("restart-the-machine", "kernel capabilities uid", 169, "0xfee1dead, 672274793, 0x5357, 0"),
    _reach("swap", "kernel capabilities uid", 167, "b'/proc/self/exe', 0"),
    _reach("account", "kernel capabilities uid", 163, "b'/proc/self'"),
    _reach("quotas", "kernel", 179, "0x800001 << 8, 0, 0, 0"),
    _reach("hang-up-the-terminal", "kernel capabilities uid", 153),
    _reach("name-the-machine", "kernel capabilities uid", 170, "b'blender', 7"),
    _reach("name-the-domain", "kernel capabilities uid", 171, "b'(none)', 6"),
    _reach("set-the-time-zone", "kernel capabilities uid", 164, "0, bytes(8)"),
    _reach("set-a-clock", "kernel capabilities uid", 227, "0, struct.pack('qq', int(time.time()), 0)"),
    _reach("adjust-the-clock", "kernel capabilities uid", 159, "struct.pack('I', 0x4000) + bytes(204)"),
    _call("use-the-ports-of-the-machine", "kernel capabilities uid", "syscall(172, 3) == 0"),
    _call("use-a-port-of-the-machine", "kernel capabilities uid", "syscall(173, 0x80, 1, 1) == 0"),
    _call("another-personality", "kernel", "syscall(135, 0x40000) >= 0"),
    _call("a-table-of-segments", "kernel", "syscall(154, 0, ctypes.create_string_buffer(64), 64) >= 0"),
    _call("a-file-in-memory", "memfd", "number = os.memfd_create('x')\nos.write(number, b'x')"),
    _call("a-secret-file-in-memory", "memfd", "syscall(447, 0)"),
    _call(
        "a-file-by-handle",
        "kernel",
        "handle = ctypes.create_string_buffer(struct.pack('Ii', 128, 0) + bytes(128))\n"
        "syscall(303, -100, b'.', handle, ctypes.byref(ctypes.c_int()), 0) == 0",
    ),
    _reach("watch-files-of-all", "kernel capabilities uid", 300, "4, 0"),
    # Rights.
    _call(
        "become-somebody-else",
        "capabilities uid",
        "c('setresuid', 12345, 12345, 12345) == 0",
        spoils=True,
        denied=("22",),
    ),
    _call("become-root", "capabilities uid", "os.getuid() and c('setresuid', 0, 0, 0) == 0", denied=("22",)),
    _call(
        "become-another-group",
        "capabilities uid",
        "c('setresgid', 12345, 12345, 12345) == 0",
        spoils=True,
        denied=("22",),
    ),
    _call(
        "join-groups", "capabilities uid", "os.setgroups([0, 4, 6, 27]) or True", spoils=True, denied=("22",)
    ),
    _call(
        "read-files-as-somebody-else",
        "capabilities uid",
        "c('setfsuid', 12345)\nlibc.setfsuid(-1) == 12345",
        spoils=True,
    ),
    _call(
        "raise-its-capabilities",
        "capabilities uid",
        "every = (1 << 32) - 1\n"
        "syscall(126, struct.pack('Ii', 0x20080522, 0), struct.pack('6I', *[every] * 6)) == 0",
    ),
    _call("keep-capabilities", "capabilities uid", "c('prctl', 47, 2, 21, 0, 0) == 0"),
    _call("set-secure-bits", "capabilities uid", "c('prctl', 28, 0, 0, 0, 0) == 0"),
    _call(
        "have-any-capability",
        "capabilities uid",
        "[line for line in read('/proc/self/status').decode().splitlines() "
        "if line[:6] in ('CapInh', 'CapPrm', 'CapEff', 'CapAmb') and int(line.split()[1], 16)]",
    ),
    _call(
        "be-root",
        "uid",
        "os.stat('/proc/self').st_uid == 0 and open('/proc/self/uid_map').read().split()[0:2] == ['0', '0']",
    ),
    _call(
        "a-filter-of-its-own",
        "signals",
        "steps = ctypes.create_string_buffer(struct.pack('HBBI', 6, 0, 0, 0x7fff0000))\n"
        "c('prctl', 22, 2, struct.pack('HxxxxxxQ', 1, ctypes.addressof(steps)), 0, 0) == 0",
        spoils=True,
    ),
    _call(
        "a-filter-of-its-own-by-seccomp",
        "limits",
        "steps = ctypes.create_string_buffer(struct.pack('HBBI', 6, 0, 0, 0x7fff0000))\n"
        "syscall(317, 1, 0, struct.pack('HxxxxxxQ', 1, ctypes.addressof(steps))) == 0",
        spoils=True,
    ),
    _call(
        "a-filter-that-asks-it",
        "limits",
        "steps = ctypes.create_string_buffer(struct.pack('HBBI', 6, 0, 0, 0x7fff0000))\n"
        "syscall(317, 1, 8, struct.pack('HxxxxxxQ', 1, ctypes.addressof(steps)))",
        spoils=True,
    ),
    _call(
        "run-before-all-others",
        "capabilities signals uid",
        "c('sched_setscheduler', 0, 1, struct.pack('i', 50)) == 0",
    ),
    way(
        "be-served-before-others",
        "capabilities signals uid",
        "os.setpriority(os.PRIO_PROCESS, 0, -10) or True",
    ),
    *(
        way(
            f"open-{device.strip('/').replace('/', '-')}",
            "files",
            f"os.open({device!r}, os.O_RDWR | os.O_NONBLOCK)",
            ready=lambda device=device: Path(device).exists(),
        )
        for device in (
            "/dev/kvm",
            "/dev/fuse",
            "/dev/net/tun",
            "/dev/vsock",
            "/dev/vhost-vsock",
            "/dev/loop-control",
            "/dev/userfaultfd",
            "/dev/uinput",
            "/dev/hpet",
            "/dev/ppp",
            "/dev/snapshot",
            "/dev/cpu_dma_latency",
            "/dev/mapper/control",
            "/dev/watchdog0",
            "/dev/rtc0",
        )
    ),
)
