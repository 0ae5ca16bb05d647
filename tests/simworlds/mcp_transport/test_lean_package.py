"""The MCP package, loaded for a server: without its client, which is there when it is asked for."""

from __future__ import annotations

import json
import subprocess
import sys

_LOADED = "print(json.dumps(sorted(sys.modules)))"


def _run(*lines: str) -> str:
    """What a new process prints that runs these lines."""
    script = "\n".join(("import json, sys", *lines))
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout


def _lean(*lines: str) -> str:
    return _run(
        "from simworlds.mcp_transport.lean_package import load_server_only", "load_server_only()", *lines
    )


def test_a_server_is_loaded_without_client_and_cryptography() -> None:
    loaded = json.loads(_lean("import mcp, kb_serve.server, simworlds.mcp_transport.http", _LOADED))
    assert "mcp.server.lowlevel.server" in loaded
    beside = {"mcp.client", "mcp.server.mcpserver", "httpx2", "cryptography"}
    assert not beside & set(loaded)
    assert beside <= set(json.loads(_run("import mcp", _LOADED)))  # else this test proves nothing


def test_what_is_left_out_is_there_when_it_is_asked_for() -> None:
    told = _lean(
        "from mcp.server.lowlevel import Server as lowlevel",
        "from mcp.server import Server, MCPServer",
        "from mcp import ClientSession, types",
        "import mcp",
        "import mcp.client.client",
        "print(Server is lowlevel, mcp.server.MCPServer is MCPServer, mcp.ClientSession is ClientSession)",
        "print(hasattr(mcp, 'nothing'), hasattr(mcp.server, 'nothing'))",
    )
    assert told.split() == ["True", "True", "True", "False", "False"]


def test_a_loaded_package_is_left_as_it_is() -> None:
    told = _run(
        "import mcp",
        "from simworlds.mcp_transport.lean_package import load_server_only",
        "before = dict(sys.modules)",
        "load_server_only()",
        "print(all(sys.modules[name] is module for name, module in before.items() if name.startswith('mcp')))",
    )
    assert told.strip() == "True"


def test_a_package_whose_server_needs_all_of_it_is_loaded_as_a_whole() -> None:
    told = _run(
        "from simworlds.mcp_transport import lean_package",
        "lean_package._SERVER = 'mcp.server.not_there'",
        "lean_package.load_server_only()",
        "print('mcp' in sys.modules)",
        "import mcp",
        "print(type(mcp).__name__, mcp.ClientSession.__name__)",
    )
    assert told.split() == ["False", "module", "ClientSession"]
