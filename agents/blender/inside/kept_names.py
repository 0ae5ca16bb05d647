# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts names back that code has changed: in modules that others depend on, the builtins, and ``sys.modules``."""

import builtins
import operator
import sys
import types

# Modules of which every name is put back: the tools depend on them, and so do a user's add-ons.
_MODULES = (
    *("ast", "builtins", "contextlib", "ctypes", "fcntl", "functools", "gc", "hashlib", "hmac"),
    *("importlib", "io"),
    *("json", "json.decoder", "json.encoder", "linecache", "math", "os", "posixpath", "re"),
    *("signal", "struct"),
    *("threading", "time", "traceback", "types", "bpy", "bpy.ops", "bpy.path", "bpy.utils", "mathutils"),
)
# Bound here: code may put other functions into the builtins before they are looked through.
_all, _map, _is = all, map, operator.is_
_CODE = (types.FunctionType, types.BuiltinFunctionType, types.ModuleType, type)


class KeptNames:
    """Remembers names as they are when it is made. ``packages`` are ours: what they define is kept, too."""

    def __init__(self, packages):
        self._packages = packages
        self._within = tuple(f"{name}." for name in packages)
        self._table = sys.modules
        self._modules = {**sys.modules}
        self._names = [
            (module, {**vars(module)}) for name in _MODULES if (module := sys.modules.get(name)) is not None
        ]
        self._code = {}
        for module, names in self._names:
            self._remember_code(module.__name__, names)
        self._seen = 0
        self._builtins = {**vars(builtins)}

    def protect_packages(self):
        """Has the functions and classes of all modules of ``packages`` that are loaded put back as well."""
        if len(sys.modules) == self._seen:
            return
        self._seen = len(sys.modules)
        known = {id(module) for module, _ in self._names}
        for module in list(sys.modules.values()):
            name = str(getattr(module, "__name__", ""))
            if (name in self._packages or name.startswith(self._within)) and id(module) not in known:
                code = {name: value for name, value in vars(module).items() if isinstance(value, _CODE)}
                self._names.append((module, code))
                self._remember_code(module.__name__, code)

    def forget_modules(self, loaded):
        """Forgets modules of ``packages`` that are not among ``loaded``: code has imported them, and may have changed
        them."""
        for name in [name for name in sys.modules.keys() - loaded if name.startswith(self._within)]:
            del sys.modules[name]
            above, _, last = name.rpartition(".")
            if above in sys.modules:
                vars(sys.modules[above]).pop(last, None)

    def _remember_code(self, module, names):
        """Remembers what the module's own functions and methods do: code can be put into a function as it stands."""
        own = [
            value
            for value in names.values()
            if isinstance(value, (types.FunctionType, type)) and value.__module__ == module
        ]
        classes = [value for value in own if isinstance(value, type)]
        for value in [*own, *(value for owner in classes for value in vars(owner).values())]:
            function = value
            if isinstance(value, (staticmethod, classmethod)):
                function = value.__func__
            elif isinstance(value, property):
                function = value.fget
            if isinstance(function, types.FunctionType):
                kept = (function.__code__, function.__defaults__, function.__kwdefaults__)
                self._code[id(function)] = (function, *kept)

    def restore(self, *, functions=True):
        """Puts back names, what functions do, the builtins, and modules that are gone from ``sys.modules``.

        New names in modules stay: importing a submodule adds one. ``functions``: whether some may have got other code;
        looking takes a millisecond, as Python tells its audit hooks of every look.
        """
        sys.modules = self._table
        for module, kept in self._names:
            now = vars(module)
            if _all(_map(_is, _map(now.get, kept), kept.values())):
                continue
            for name, value in kept.items():
                if now.get(name) is not value:
                    now[name] = value
        for function, code, defaults, of_keywords in self._code.values() if functions else ():
            if function.__code__ is not code:
                function.__code__ = code
            if function.__defaults__ is not defaults:
                function.__defaults__ = defaults
            if function.__kwdefaults__ is not of_keywords:
                function.__kwdefaults__ = of_keywords
        for name in vars(builtins).keys() - self._builtins.keys():
            del vars(builtins)[name]  # pyright: ignore[reportIndexIssue]
        if not self._modules.keys() <= sys.modules.keys():
            for name, module in self._modules.items():
                sys.modules.setdefault(name, module)
        for module, _ in self._names:
            sys.modules[module.__name__] = module
