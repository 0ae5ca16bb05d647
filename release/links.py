"""Links that add the server to an editor at a click, and the commands that do it elsewhere."""

from __future__ import annotations

import base64
import json
from urllib.parse import quote

NAME = "blender-docs"
SERVER = {"command": "uvx", "args": ["simworlds", "serve"]}


def cursor_link() -> str:
    """The link that Cursor takes."""
    config = base64.b64encode(_json(SERVER).encode()).decode()
    return f"https://cursor.com/install-mcp?name={NAME}&config={quote(config, safe='')}"


def vscode_link() -> str:
    """The link that VS Code takes, by way of a page: sites may not link to vscode: itself."""
    inner = f"vscode:mcp/install?{quote(_json({'name': NAME, **SERVER}), safe='')}"
    return f"https://insiders.vscode.dev/redirect?url={quote(inner, safe='')}"


def _json(value: object) -> str:
    return json.dumps(value, separators=(",", ":"))
