# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts a module in Blender: ``boot.py -- MODULE NAME=FOLDER … -- ARGUMENT …``.

Each NAME becomes a package that holds the modules of FOLDER; then MODULE is imported and its ``main`` is called with
the list of arguments. The packages that stand above a NAME are empty, so nothing else of SimWorlds can be imported, and
``sys.path`` stays as Blender made it.

In a sandbox, the first thing done is to close the system calls that only the way here needed, in all threads.
"""

import ctypes
import importlib
import importlib.util
import os
import struct
import sys
import types

_EXIT_CODE = 126
_SET_MODE_FILTER, _ALL_THREADS = 1, 1


def close_calls():
    """Installs the second filter of system calls, if the launcher left one; if that fails, the process ends."""
    given = os.environ.pop("SIMWORLDS_LAST_FILTER", None)
    if given is None:
        return
    call, program = given.split(":")
    program = bytes.fromhex(program)
    steps = ctypes.create_string_buffer(program, len(program))
    described = struct.pack("HxxxxxxQ", len(program) // 8, ctypes.addressof(steps))
    kernel = ctypes.CDLL(None, use_errno=True)
    if kernel.syscall(int(call), _SET_MODE_FILTER, _ALL_THREADS, described) != 0:
        os.write(2, b"Blender cannot be confined: the second filter of system calls was refused\n")
        os._exit(_EXIT_CODE)


def add_package(name, folder):
    """Makes ``folder`` the package ``name`` (dotted), below empty packages where there are none yet."""
    above = None
    parts = name.split(".")
    for count in range(1, len(parts)):
        full = ".".join(parts[:count])
        if full not in sys.modules:
            package = types.ModuleType(full)
            package.__path__ = []
            sys.modules[full] = package
            if above is not None:
                setattr(above, parts[count - 1], package)
        above = sys.modules[full]
    place = os.path.join(folder, "__init__.py")
    spec = importlib.util.spec_from_file_location(name, place, submodule_search_locations=[folder])
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    if above is not None:
        setattr(above, parts[-1], package)


def main(words):
    """``words``: the module, its packages, ``--``, and the arguments of its ``main``."""
    middle = words.index("--")
    module, *packages = words[:middle]
    for package in packages:
        add_package(*package.split("=", 1))
    importlib.import_module(module).main(words[middle + 1 :])


if __name__ == "__main__":
    close_calls()
    main(sys.argv[sys.argv.index("--") + 1 :])
