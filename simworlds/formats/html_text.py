"""The text of a page, made fit for HTML."""

from __future__ import annotations

import re

# Characters that HTML does not allow, and those that change the direction of text.
_UNFIT = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\u202a-\u202e\u2066-\u2069\ufffe\uffff]")


def fit_for_html(text: str) -> str:
    """The text, with a replacement character for each that HTML does not allow or that turns the text's direction."""
    return _UNFIT.sub("\N{REPLACEMENT CHARACTER}", text)
