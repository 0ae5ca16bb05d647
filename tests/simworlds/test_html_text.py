"""Text made fit for HTML."""

from __future__ import annotations

from simworlds.formats.html_text import fit_for_html


def test_only_what_html_lacks_and_what_turns_text_is_replaced() -> None:
    assert fit_for_html("<b>ä\t1\n</b> \N{PILE OF POO}") == "<b>ä\t1\n</b> \N{PILE OF POO}"
    assert fit_for_html("a\0b\rc\x7fd\x9be\udcfff\u202eg\ufffeh") == "a�b�c�d�e�f�g�h"
