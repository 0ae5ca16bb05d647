# SPDX-License-Identifier: GPL-3.0-or-later
"""Tries out what works in this Blender. Most checks replace the open file."""

import ctypes
import errno
import os
import socket
import subprocess
import time

import bpy

from .render.engines import WORKBENCH, best_engine

_PIXELS = 64
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")


# Machine → numbers of calls that do no harm: asking for a keyring, a descriptor for io_uring, one for bpf
_RARE_CALLS = {"x86_64": (250, 425, 321), "aarch64": (219, 425, 280)}
_DENIED = (errno.EPERM, errno.ENOSYS, errno.EACCES)


def try_escapes(arguments, report):
    """Tries each wall of the sandbox that can be tried from inside. Returns {wall: whether it fails to hold}.

    ``file``, ``link`` and ``folder`` are outside what may be read and written; ``variable`` is an environment variable.
    What works is undone, or does nothing.
    """
    del report
    file, folder, link = arguments["file"], arguments["folder"], arguments["link"]
    return {
        "files": _works(lambda: open(file).close())
        or _works(lambda: open(os.path.join(folder, "written"), "w").close()),
        "proc": any(map(_can_be_written, ("/proc/sys/kernel/core_pattern", "/proc/self/oom_score_adj"))),
        "uid": os.getuid() == 0 and _is_root_outside(),
        "capabilities": int(_status("CapEff") or "0", 16) != 0,
        "namespaces": _sees_other_processes(),
        "sockets": _works(lambda: socket.socket().close())
        or _works(lambda: [end.close() for end in socket.socketpair()]),
        "processes": _works(lambda: subprocess.run(["true"], check=False)) or _may_execute(),
        "signals": _works(lambda: os.kill(os.getppid(), 0)),
        "memfd": hasattr(os, "memfd_create") and _works(lambda: os.close(os.memfd_create("tried"))),
        "attributes": _works(lambda: os.readlink(link)) or _works(lambda: os.listxattr(file)),
        "kernel": _does_rare_calls(),
        "limits": _sets_a_limit(),
        "environment": arguments["variable"] in os.environ,
    }


def _works(act):
    try:
        act()
    except (OSError, AttributeError):
        return False
    return True


def _can_be_written(path):
    return _works(lambda: os.close(os.open(path, os.O_WRONLY)))


def _status(name):
    """A row of this process's status; None where there is none."""
    try:
        with open("/proc/self/status") as rows:
            return next((row.split()[1] for row in rows if row.startswith(name + ":")), None)
    except OSError:
        return None


def _is_root_outside():
    try:
        with open("/proc/self/uid_map") as rows:
            return any(row.split()[:2] == ["0", "0"] for row in rows)
    except OSError:
        return True


def _sees_other_processes():
    """Beside its own there is at most the one that bubblewrap puts first."""
    try:
        return len([name for name in os.listdir("/proc") if name.isdigit()]) > 2
    except OSError:
        return False


def _may_execute():
    try:
        os.execv("/nonexistent/program", ["program"])  # noqa: S606
    except OSError as error:
        return error.errno not in _DENIED
    return False


def _does_rare_calls():
    if not hasattr(os, "uname") or os.uname().machine not in _RARE_CALLS:
        return False
    keys, ring, program = _RARE_CALLS[os.uname().machine]
    libc = ctypes.CDLL(None, use_errno=True)
    for call in ((keys, 0, -3, 0), (ring, 0, 0), (program, -1, 0, 0)):
        ctypes.set_errno(0)
        if libc.syscall(*call) >= 0 or ctypes.get_errno() not in _DENIED:
            return True
    return False


def _sets_a_limit():
    """Sets a limit to what it is."""
    import resource

    try:
        resource.setrlimit(resource.RLIMIT_CORE, resource.getrlimit(resource.RLIMIT_CORE))
    except (OSError, ValueError):
        return False
    return True


def workbench(arguments, report):
    """Draws a cube. Returns ``fault`` ("" if Workbench can draw), ``seconds``, ``renderer`` (the GPU's name, if known)
    and whether that is ``software``."""
    del arguments
    report(0, None, "drawing with Workbench")
    engine, fault = best_engine()
    if engine != WORKBENCH:
        return {"fault": fault, "seconds": 0.0, "renderer": "", "software": False}
    scene = _scene()
    scene.render.engine = WORKBENCH
    seconds, shades = _rendered(scene)
    renderer = _renderer()
    return {
        "fault": "" if shades > 1 else "the rendered picture is empty",
        "seconds": seconds,
        "renderer": renderer,
        "software": any(word in renderer.lower() for word in _SOFTWARE),
    }


def cycles(arguments, report):
    """Renders a cube on the processor. Returns ``fault``, ``seconds`` and ``devices``: {type: names of GPUs}."""
    del arguments
    report(0, None, "rendering with Cycles")
    scene = _scene()
    try:
        scene.render.engine = "CYCLES"
    except TypeError:
        return {"fault": "this Blender was built without Cycles", "seconds": 0.0, "devices": {}}
    scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 1, "CPU", False
    seconds, shades = _rendered(scene)
    return {
        "fault": "" if shades > 1 else "the rendered picture is empty",
        "seconds": seconds,
        "devices": _devices(),
    }


def video(arguments, report):
    """Returns ``supported``: whether video can be written, and the ``version`` of the codec library."""
    del arguments, report
    written = bpy.app.ffmpeg
    return {"supported": bool(written.supported), "version": ".".join(map(str, written.avcodec_version))}


def _scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add(rotation=(0.5, 0.5, 0))
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location.z = 6
    lamp = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "SUN"))
    for obj in (scene.camera, lamp):
        scene.collection.objects.link(obj)
    scene.render.resolution_x = scene.render.resolution_y = _PIXELS
    scene.render.resolution_percentage = 100
    return scene


def _rendered(scene):
    """(seconds, number of different shades of green in the picture)."""
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.join(bpy.app.tempdir, "checkup.png")
    started = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - started
    image = bpy.data.images.load(scene.render.filepath)
    shades = len({round(value, 2) for value in list(image.pixels)[1::4]})
    os.unlink(scene.render.filepath)
    return seconds, shades


def _renderer():
    try:
        import gpu

        return str(gpu.platform.renderer_get())
    except (ImportError, SystemError):  # no GPU context for Python
        return ""


def _devices():
    addon = bpy.context.preferences.addons.get("cycles")
    names_by_type = {}
    for kind in ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI"):
        try:
            devices = addon.preferences.get_devices_for_type(kind)
        except (AttributeError, ValueError, TypeError):
            continue
        names = [device.name for device in devices or () if device.type == kind]
        if names:
            names_by_type[kind] = names
    return names_by_type
