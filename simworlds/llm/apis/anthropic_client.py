"""The client of Anthropic's package, with what a user has set: a key or token, and perhaps another server's address."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import httpx2
from anthropic import Anthropic

from simworlds.llm.errors import Rejected

if TYPE_CHECKING:
    from typing import Self


class Credentials(NamedTuple):
    """A key or else a token; the other is empty."""

    key: str
    token: str

    @classmethod
    def found(cls, given: str | None) -> Self | None:
        """The ``given`` key, or else ANTHROPIC_API_KEY's, or else the token ANTHROPIC_AUTH_TOKEN; None without any.

        Raises Rejected where it cannot be sent.
        """
        key = (given or os.environ.get("ANTHROPIC_API_KEY") or "").strip()
        token = "" if key else os.environ.get("ANTHROPIC_AUTH_TOKEN", "").strip()
        if not (key + token).isascii() or not (key + token).isprintable():
            name = "ANTHROPIC_API_KEY" if key else "ANTHROPIC_AUTH_TOKEN"
            raise Rejected(f"{name} contains characters that are not allowed in keys. Copy the key again.")
        return cls(key, token) if key or token else None


def anthropic_client(
    credentials: Credentials, *, base_url: str | None, timeout: httpx2.Timeout, max_retries: int
) -> Anthropic:
    """The package's client of the server at ``base_url``, by default ANTHROPIC_BASE_URL, or else Anthropic's own.

    Raises Rejected where the address is none.
    """
    try:
        client = Anthropic(
            api_key=credentials.key or None,
            auth_token=credentials.token or None,
            base_url=base_url,
            timeout=timeout,
            max_retries=max_retries,
        )
    except (httpx2.InvalidURL, ValueError) as error:
        raise Rejected(
            f"The address of the model (ANTHROPIC_BASE_URL) or of a proxy is invalid: {error}. Correct it or unset it."
        ) from error
    if client.base_url.scheme not in ("http", "https") or not client.base_url.host:
        raise Rejected(
            f"The address of the model (ANTHROPIC_BASE_URL) is not an HTTP URL: {client.base_url}. Correct it "
            "or unset it."
        )
    return client
