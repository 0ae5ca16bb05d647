"""Ways to change what is not Blender's: files, folders, modes, attributes, what the run keeps to itself."""

from __future__ import annotations

from way import Way, way


def _shared(place: str) -> Way:
    return way(
        f"a-file-in-{place.strip('/').replace('/', '-') or 'the-root'}",
        "files",
        f"write({place!r} + '/' + target.mark)",
    )


WAYS = (
    way("overwrite", "files", "write(target.victim)"),
    way("append", "files", "open(target.victim, 'a').write('x')"),
    way("truncate", "files", "os.truncate(target.victim, 0)"),
    way("open-to-truncate", "files", "os.open(target.victim, os.O_RDONLY | os.O_TRUNC)"),
    way("remove", "files", "os.unlink(target.victim)"),
    way("rename", "files", "os.rename(target.victim, target.victim + '2')"),
    way("replace", "files", "write('mine')\nos.replace('mine', target.victim)"),
    way("make-a-file", "files", "write(target.folder + '/planted')"),
    way("make-a-folder", "files", "os.mkdir(target.folder + '/planted')"),
    way("make-a-link", "files", "os.symlink('/', target.folder + '/planted')"),
    way("make-a-hard-link", "files", "write('mine')\nos.link('mine', target.folder + '/planted')"),
    way("make-a-fifo", "files", "os.mkfifo(target.folder + '/planted')"),
    way("make-a-nameless-file", "files", "os.open(target.folder, os.O_TMPFILE | os.O_RDWR)"),
    way("remove-a-folder", "files", "import shutil\nshutil.rmtree(target.folder + '/deep')"),
    way("change-a-mode", "files uid", "os.chmod(target.victim, 0o600)"),
    way("change-an-owner", "files uid capabilities", "os.chown(target.victim, 12345, 12345)"),
    way("change-times", "files uid", "os.utime(target.victim, (1, 1))"),
    way("set-an-attribute", "files", "os.setxattr(target.victim, 'user.planted', b'x')"),
    way("remove-an-attribute", "files", "os.removexattr(target.file, 'user.note')"),
    way("write-through-a-link", "files", "os.symlink(target.victim, 'link')\nwrite('link')"),
    way("write-through-a-linked-folder", "files", "os.symlink(target.folder, 'link')\nwrite('link/planted')"),
    way(
        "write-through-a-descriptor-for-reading",
        "files",
        "number = os.open(target.readable, os.O_RDONLY)\nwrite(f'/proc/self/fd/{number}')",
    ),
    way(
        "by-openat2-to-truncate",
        "files",
        "syscall(437, -100, target.victim.encode(), struct.pack('QQQ', os.O_TRUNC, 0, 0), 24)",
        machine="x86_64",
    ),
    # What may be read must not be changed either: Blender's and Python's own files.
    way("overwrite-what-may-be-read", "files", "write(target.readable)"),
    way("truncate-what-may-be-read", "files", "os.truncate(target.readable, 0)"),
    way("open-to-truncate-what-may-be-read", "files", "os.open(target.readable, os.O_RDONLY | os.O_TRUNC)"),
    way("change-the-mode-of-what-may-be-read", "files", "os.chmod(target.readable, 0o4777)"),
    way("change-the-mode-by-descriptor", "files", "os.fchmod(os.open(target.readable, os.O_RDONLY), 0o777)"),
    way("change-the-times-of-what-may-be-read", "files", "os.utime(target.readable, (1, 1))"),
    way(
        "set-an-attribute-of-what-may-be-read", "files", "os.setxattr(target.readable, 'user.planted', b'x')"
    ),
    way(
        "set-an-attribute-by-setxattrat",
        "files",
        "value = ctypes.create_string_buffer(b'x')\n"
        "arguments = struct.pack('QII', ctypes.addressof(value), 1, 0)\n"
        "syscall(463, -100, target.readable.encode(), 0, b'user.planted', arguments, 16)",
        machine="x86_64",
    ),
    way(
        "set-the-flags-of-what-may-be-read",
        "files",
        "import fcntl\nnumber = os.open(target.readable, os.O_RDONLY)\n"
        "flags = struct.unpack('l', fcntl.ioctl(number, 0x80086601, bytes(8)))[0]\n"
        "fcntl.ioctl(number, 0x40086602, struct.pack('l', flags | 0x40))",
        denied=("25",),
    ),  # not to be dumped
    way(
        "set-the-extended-flags-of-what-may-be-read",
        "files",
        "import fcntl\nnumber = os.open(target.readable, os.O_RDONLY)\n"
        "flags = bytearray(fcntl.ioctl(number, 0x801C581F, bytes(28)))\nflags[0] |= 0x80\n"
        "fcntl.ioctl(number, 0x401C5820, bytes(flags))",
        denied=("25",),
    ),
    way("link-what-may-be-read", "files", "os.link(target.readable, 'mine')"),
    way(
        "lease-what-may-be-read",
        "files signals",
        "import fcntl\nnumber = os.open(target.readable, os.O_RDONLY)\nfcntl.fcntl(number, 1024, 0)\n"
        "fcntl.fcntl(number, 1025) == 0",
        denied=("22",),
    ),
    way(
        "watch-what-may-be-read",
        "signals",
        "import fcntl\nnumber = os.open(os.path.dirname(target.readable), os.O_RDONLY)\n"
        "fcntl.fcntl(number, 1026, 0x80000002) == 0",
    ),
    # What Blender itself writes.
    way("save-a-scene", "files", "bpy.ops.wm.save_as_mainfile(filepath=target.folder + '/planted.blend')"),
    way("save-an-image", "files", "bpy.data.images.new('i', 4, 4).save(filepath=target.victim)"),
    way(
        "save-a-text",
        "files",
        "text = bpy.data.texts.new('t')\ntext.write('x')\ntext.filepath = target.victim\n"
        "with bpy.context.temp_override(edit_text=text): bpy.ops.text.save()",
    ),
    way(
        "render-a-picture",
        "files",
        "scene = bpy.context.scene\nscene.camera = bpy.data.objects.new('C', bpy.data.cameras.new('C'))\n"
        "scene.collection.objects.link(scene.camera)\nscene.render.engine = 'CYCLES'\n"
        "scene.cycles.samples = 1\n"
        "scene.render.resolution_x = scene.render.resolution_y = 8\n"
        "scene.render.filepath = target.folder + '/planted'\n"
        "bpy.ops.render.render(write_still=True)",
    ),
    way(
        "export-a-mesh",
        "files",
        "bpy.ops.mesh.primitive_cube_add()\nbpy.ops.wm.obj_export(filepath=target.folder + '/planted.obj')",
    ),
    way(
        "save-preferences",
        "files",
        "os.environ['BLENDER_USER_CONFIG'] = target.folder\nbpy.ops.wm.save_userpref()",
    ),
    way(
        "bake-into-a-folder",
        "files",
        "bpy.ops.mesh.primitive_cube_add()\nbody = bpy.context.object\n"
        "fluid = body.modifiers.new('F', 'FLUID')\n"
        "fluid.fluid_type = 'DOMAIN'\ndomain = fluid.domain_settings\n"
        "domain.cache_directory = target.folder + '/planted'\n"
        "domain.resolution_max = 6\ndomain.cache_type = 'ALL'\ndomain.cache_frame_end = 2\n"
        "bpy.ops.fluid.bake_all()",
    ),
    way(
        "write-a-library",
        "files",
        "bpy.data.libraries.write(target.folder + '/planted.blend', {bpy.context.scene})",
        denied=("OSError",),
    ),
    # The run's own folders.
    way("a-file-beside-the-workspace", "files", "write(target.root + '/' + target.mark)"),
    way("a-checkpoint-of-its-own", "files", "write(target.root + '/checkpoints/999999.blend')"),
    way("overwrite-a-checkpoint", "files", "write(target.root + '/checkpoints/000001.blend')"),
    way("move-the-workspace", "files", "os.rename(target.workspace, target.root + '/' + target.mark)"),
    way(
        "replace-the-workspace-by-a-link",
        "files",
        "os.rename(target.workspace, target.workspace + target.mark)\n"
        "os.symlink(target.folder, target.workspace)",
    ),
    way("take-the-lock", "files", "os.unlink(target.root + '/.lock') or True"),
    way(
        "swap-private-and-workspace",
        "files",
        "syscall(316, -100, target.private.encode(), -100, target.workspace.encode(), 2) == 0",
        machine="x86_64",
        denied=("16",),
    ),
    # Programs that somebody else starts.
    way(
        "a-program-that-runs-as-its-owner", "uid files", "write('program')\nos.chmod('program', 0o4755)\nNone"
    ),
    way(
        "a-program-that-runs-as-its-owner-at-once",
        "uid files",
        "os.umask(0)\nos.open('program', os.O_CREAT | os.O_WRONLY, 0o6755)\nNone",
    ),
    way(
        "a-program-with-capabilities",
        "files uid capabilities",
        "write('program')\n"
        "os.setxattr('program', 'security.capability', struct.pack('<IIIII', 0x2000001, 1 << 21, "
        "0, 0, 0))\nTrue",
        denied=("22",),
    ),
    *map(
        _shared,
        (
            "/tmp",
            "/var/tmp",
            "/dev/shm",
            "/run",
            "/",
            "/etc",
            "/usr",
            "/dev",
            "/dev/mqueue",
            "/sys/fs/cgroup",
            "/home",
        ),
    ),
)
