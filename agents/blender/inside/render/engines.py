# SPDX-License-Identifier: GPL-3.0-or-later
"""Which engine can draw on this machine. Workbench without OpenGL crashes Blender, so OpenGL is tested before."""

import ctypes
import functools
import sys

import bpy

WORKBENCH, CYCLES = "BLENDER_WORKBENCH", "CYCLES"
_SURFACELESS, _OPENGL_API, _RENDERABLE, _OPENGL_BIT, _SURFACE = 0x31DD, 0x30A2, 0x3040, 0x8, 0x3033
_MAJOR, _MINOR, _PROFILE, _CORE, _END = 0x3098, 0x30FB, 0x30FD, 0x1, 0x3038


def best_engine():
    """(Workbench, "") if that can draw, else (Cycles, reason)."""
    fault = _opengl_fault()
    return (WORKBENCH, "") if not fault else (CYCLES, fault)


@functools.lru_cache(maxsize=1)
def _opengl_fault():
    """Why OpenGL is not available without a display; "" if it is. Only Linux needs the test."""
    if sys.platform != "linux" or not bpy.app.background:
        return ""
    if bpy.app.version < (4, 0, 0):
        return "this Blender can draw only on a display"
    try:
        return _test_opengl(_load_egl())
    except (OSError, AttributeError):
        return "there is no libEGL"


def _test_opengl(egl):
    display = egl.eglGetPlatformDisplay(_SURFACELESS, None, None)
    if not display or not egl.eglInitialize(display, None, None) or not egl.eglBindAPI(_OPENGL_API):
        return "EGL finds no driver"
    config, count = ctypes.c_void_p(), ctypes.c_int()
    wanted = (ctypes.c_int * 5)(_RENDERABLE, _OPENGL_BIT, _SURFACE, 0, _END)
    egl.eglChooseConfig(display, wanted, ctypes.byref(config), 1, ctypes.byref(count))
    version = (ctypes.c_int * 7)(_MAJOR, 4, _MINOR, 3, _PROFILE, _CORE, _END)
    context = egl.eglCreateContext(display, config, None, version) if count.value else None
    if not context:
        return "the driver has no OpenGL 4.3"
    egl.eglDestroyContext(display, context)
    return ""


def _load_egl():
    egl = ctypes.CDLL("libEGL.so.1")
    pointer, number = ctypes.c_void_p, ctypes.c_int
    egl.eglGetPlatformDisplay.restype = egl.eglCreateContext.restype = pointer
    egl.eglGetPlatformDisplay.argtypes = [number, pointer, pointer]
    egl.eglInitialize.argtypes = [pointer] * 3
    egl.eglChooseConfig.argtypes = [pointer, pointer, pointer, number, pointer]
    egl.eglCreateContext.argtypes = [pointer] * 4
    egl.eglDestroyContext.argtypes = [pointer] * 2
    return egl
