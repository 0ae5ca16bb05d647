"""Loads of the MCP package only what a server needs.

Its packages import all that is in them: its client, a second kind of server, and with these httpx2 and cryptography.
That is a fifth of the memory with which a server starts, and of the time that it takes to.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from threading import RLock
from types import ModuleType

_PACKAGES = ("mcp", "mcp.server")
_SERVER = "mcp.server.lowlevel"
_TURN = RLock()
_UNREAD: set[str] = set()  # the packages whose own code has not run


class _Package(ModuleType):
    """A package whose own code runs when it is first asked for a name that is not in it yet."""

    def __getattr__(self, name: str) -> object:
        with _TURN:
            spec = self.__spec__
            if not name.startswith("__") and self.__name__ in _UNREAD and spec and spec.loader:
                _UNREAD.remove(self.__name__)
                spec.loader.exec_module(self)
            if name in vars(self):
                return vars(self)[name]
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


def load_server_only() -> None:
    """Loads the MCP package's server, and not what is beside it until that is asked for. Does nothing once the package
    is loaded. To be called before anything of it is imported.
    """
    if "mcp" in sys.modules:
        return
    try:
        for name in _PACKAGES:
            _put(name)
        import_module(_SERVER)
    except (ImportError, AttributeError):
        # A release whose server needs the whole package first: all is imported as it says itself.
        _UNREAD.clear()
        for name in [name for name in sys.modules if name.partition(".")[0] == "mcp"]:
            del sys.modules[name]


def _put(name: str) -> None:
    """A package without what its own code would put into it."""
    spec = find_spec(name)
    if spec is None:
        raise ImportError(f"there is no package {name}")
    package = _Package(name, None)
    package.__spec__, package.__loader__, package.__file__ = spec, spec.loader, spec.origin
    package.__path__ = spec.submodule_search_locations or []
    package.__package__ = name
    _UNREAD.add(name)
    sys.modules[name] = package
    parent, _, own = name.rpartition(".")
    if parent:
        setattr(sys.modules[parent], own, package)
