"""Ways to read what is not Blender's: files, names, links, attributes, pictures, the machine's own files."""

from __future__ import annotations

from pathlib import Path

from way import Way, way

_FILES = (
    "/etc/passwd",
    "/etc/shadow",
    "/etc/hostname",
    "/etc/ssh/sshd_config",
    "/var/log/dpkg.log",
    "/proc/1/cmdline",
)
_NEVER = {"bubblewrap": ("/proc/1/cmdline",), "landlock": ()}  # there, the first process is bubblewrap's own


def _there(path: str) -> Way:
    kinds = tuple(kind for kind, never in _NEVER.items() if path not in never)
    return way(
        f"read-{path.strip('/').replace('/', '-')}",
        "files",
        f"read({path!r})",
        kinds=kinds,
        ready=lambda: Path(path).exists(),
    )


def _call(name: str, attacks: str, code: str, **more: object) -> Way:
    """A way that calls the kernel by its numbers on x86_64."""
    return way(name, attacks, code, machine="x86_64", **more)


WAYS = (
    way("open", "files", "read(target.file)"),
    way("open-a-key-in-the-home-folder", "files", "read(target.key)"),
    way("list-a-folder", "files", "os.listdir(target.names)"),
    way(
        "list-the-temporary-folder",
        "files",
        "os.path.basename(target.top) in os.listdir(os.path.dirname(target.top))",
    ),
    way(
        "list-the-home-folder",
        "files",
        "os.path.basename(target.home) in os.listdir(os.path.dirname(target.home))",
    ),
    way("through-proc-self-root", "files", "read('/proc/self/root' + target.file)"),
    way("through-proc-self-cwd", "files", "read('/proc/self/cwd' + '/..' * 20 + target.file)"),
    way(
        "through-the-root-of-another-process",
        "files signals namespaces uid",
        "read(f'/proc/{target.pid}/root{target.file}')",
    ),
    way(
        "through-the-root-of-the-first-process",
        "files signals namespaces uid capabilities",
        "read('/proc/1/root' + target.file)",
    ),
    way("through-a-link", "files", "os.symlink(target.file, 'link')\nread('link')"),
    way("through-a-linked-folder", "files", "os.symlink(target.folder, 'link')\nread('link/deep/file')"),
    way("through-a-hard-link", "files", "os.link(target.file, 'hard')\nread('hard')"),
    way(
        "through-a-hard-link-by-descriptor",
        "files",
        "os.link(f'/proc/self/fd/{os.open(target.file, os.O_PATH)}', 'h')\nread('h')",
    ),
    way("by-moving-it-in", "files", "os.rename(target.file, 'moved')\nread('moved')"),
    way(
        "by-exchanging-it",
        "files",
        "write('mine')\nsyscall(316, -100, target.file.encode(), -100, b'mine', 2)\nread('mine')",
        machine="x86_64",
    ),
    way(
        "by-path-descriptor",
        "files",
        "number = os.open(target.file, os.O_PATH)\nread(f'/proc/self/fd/{number}')",
    ),
    way(
        "by-mapping",
        "files",
        "import mmap\nmmap.mmap(os.open(target.file, os.O_RDONLY), 0, prot=mmap.PROT_READ)[:]",
    ),
    way(
        "by-the-c-library",
        "files",
        "libc.fopen.restype = ctypes.c_void_p\nlibc.fopen(target.file.encode(), b'r')",
    ),
    _call(
        "by-openat2",
        "files",
        "how = struct.pack('QQQ', 0, 0, 0)\n"
        "number = syscall(437, -100, target.file.encode(), how, 24)\nos.read(number, 99)",
    ),
    _call(
        "by-file-handle",
        "files kernel uid capabilities",
        "handle = ctypes.create_string_buffer(struct.pack('Ii', 128, 0) + bytes(128))\n"
        "mount = ctypes.c_int()\n"
        "syscall(303, -100, target.file.encode(), handle, ctypes.byref(mount), 0)\n"
        "os.read(syscall(304, os.open('.', os.O_RDONLY), handle, 0), 99)",
    ),
    way("as-a-text-of-blender", "files", "bpy.data.texts.load(target.file).as_string()"),
    way("as-an-image-of-blender", "files", "tuple(bpy.data.images.load(target.picture).size) == (37, 53)"),
    way("as-a-film-of-blender", "files", "tuple(bpy.data.movieclips.load(target.picture).size) == (37, 53)"),
    way(
        "as-a-strip-of-blender",
        "files",
        "editor = bpy.context.scene.sequence_editor_create()\n"
        "strip = editor.strips.new_image(name='s', filepath=target.picture, channel=1, frame_start=1)\n"
        "(strip.elements[0].orig_width, strip.elements[0].orig_height) == (37, 53)",
    ),
    way("as-numbers", "files", "import numpy\nnumpy.fromfile(target.file, dtype='uint8').tobytes()"),
    way(
        "as-a-database",
        "files",
        "import sqlite3\n"
        "sqlite3.connect(f'file:{target.folder}/file.db?mode=ro', uri=True).execute('select name "
        "from sqlite_master').fetchall()",
        denied=("OperationalError",),
    ),
    way(
        "as-an-archive",
        "files",
        "import tarfile, io\ntar = tarfile.open('t.tar', 'w')\ntar.add(target.file)\ntar.close()\n"
        "read('t.tar', 99999)",
    ),
    way(
        "as-a-module",
        "files",
        "import importlib.util as u\n"
        "spec = u.spec_from_file_location('m', target.folder + '/file.py')\n"
        "module = u.module_from_spec(spec)\nspec.loader.exec_module(module)\nmodule.note",
    ),
    way(
        "by-copying-in-the-kernel",
        "files",
        "source = os.open(target.file, os.O_RDONLY)\n"
        "mine = os.open('copy', os.O_RDWR | os.O_CREAT)\nos.copy_file_range(source, mine, 99)\n"
        "read('copy')",
    ),
    way("the-target-of-a-link", "files attributes", "os.readlink(target.link)", denied=("22",)),
    way("an-attribute", "files attributes", "os.getxattr(target.file, 'user.note')"),
    way("the-names-of-attributes", "files attributes", "os.listxattr(target.file)"),
    _call(
        "an-attribute-by-getxattrat",
        "files attributes",
        "value = ctypes.create_string_buffer(99)\n"
        "arguments = struct.pack('QII', ctypes.addressof(value), 99, 0)\n"
        "syscall(464, -100, target.file.encode(), 0, b'user.note', arguments, 16)\nvalue.value",
    ),
    _call(
        "names-by-fanotify",
        "files kernel uid capabilities",
        "number = syscall(300, 0x200 | 0xC00 | 2, 0)\n"  # FAN_REPORT_FID | FAN_REPORT_DFID_NAME | nonblocking
        "syscall(301, number, 1, 0x100 | 0x200 | 0x20 | 0x10 | 0x40000000 | 0x8000000, -100, "
        "target.names.encode())\nTrue",
    ),
    _call(
        "names-by-inotify",
        "files signals",
        "number = c('inotify_init1', os.O_NONBLOCK)\n"
        "c('inotify_add_watch', number, target.folder.encode(), 0x20)\nTrue",
    ),
    way(
        "names-of-sockets",
        "files namespaces sockets",
        "text = read('/proc/self/net/unix', 1 << 20).decode()\n"
        "[line for line in text.splitlines() if target.abstract in line]",
    ),
    way(
        "connections-of-others",
        "files namespaces sockets",
        "text = read('/proc/self/net/tcp', 1 << 20).decode()\n'%04X' % target.tcp in text",
    ),
    way("locks-of-others", "files namespaces", "read('/proc/locks')"),
    way("keys-of-others", "files proc", "len(read('/proc/keys')) > 0"),
    way(
        "a-raw-disk",
        "files uid capabilities",
        "[read('/dev/' + name) for name in ('vda', 'sda', 'nvme0n1', 'mem', 'port') if "
        "os.path.exists('/dev/' + name)]",
        denied=("IsADirectoryError",),
    ),
    way(
        "a-raw-disk-of-its-own-making",
        "files uid capabilities",
        "import stat\n"
        "os.mknod('disk', stat.S_IFBLK | 0o600, os.stat(os.path.realpath('.')).st_dev)\n"
        "read('disk')",
    ),
    way(
        "a-zero-device-of-its-own-making",
        "files uid capabilities",
        "import stat\nos.mknod('zero', stat.S_IFCHR | 0o600, os.makedev(1, 9))\nread('zero')",
    ),
    way(
        "the-log-of-the-kernel",
        "kernel uid capabilities",
        "buffer = ctypes.create_string_buffer(999)\nc('klogctl', 3, buffer, 999)\nbuffer.value",
    ),
    way(
        "the-log-of-the-kernel-as-a-device",
        "files uid capabilities",
        "os.read(os.open('/dev/kmsg', os.O_RDONLY | os.O_NONBLOCK), 999)",
    ),
    way("the-memory-of-the-kernel", "files proc uid capabilities", "read('/proc/kcore')"),
    way(
        "symbols-of-the-kernel",
        "files proc uid capabilities",
        "any(int(line.split()[0], 16) for line in read('/proc/kallsyms', 9999).splitlines()[:-1])",
    ),
    way(
        "the-environment-of-the-server",
        "environment",
        "[value for name, value in os.environ.items() if 'KEY' in name]",
    ),
    way(
        "the-environment-of-any-process",
        "files namespaces signals environment uid",
        "import glob\nfound = []\nfor path in glob.glob('/proc/[0-9]*/environ'):\n"
        "    text = worked(read, path, 1 << 20)\n"
        "    found += [path] if text not in (None, True) and b'sw-secret' in text else []\nfound",
    ),
    way("the-command-line-of-another-process", "files namespaces", "read(f'/proc/{target.pid}/cmdline')"),
    way(
        "an-open-file-of-another-process",
        "files namespaces signals uid",
        "read(f'/proc/{target.pid}/fd/{target.descriptor}')",
    ),
    way("the-lock-of-the-run", "files", "read(target.root + '/.lock') or True"),
    way("checkpoints", "files", "os.listdir(target.root + '/checkpoints')"),
    way(
        "a-checkpoint",
        "files",
        "folder = target.root + '/checkpoints/'\nread(folder + os.listdir(folder)[0], 9)",
    ),
    way("the-folder-of-runs", "files", "set(os.listdir(os.path.dirname(target.root))) - {'run'}"),
    *map(_there, _FILES),
)
