"""Tables that line up."""

from __future__ import annotations

from bench.markdown_tables import Table, format_table


def test_table_lines_have_equal_width_and_numbers_align_right() -> None:
    lines = format_table(
        Table("T", ("name", "n"), (("a|b", "1.5"), ("longer name", "12,000"), ("c", "–")))
    ).splitlines()[2:]
    assert len({len(line) for line in lines}) == 1
    assert lines[1].endswith(":|")
    assert lines[2].startswith("| a\\|b ")
    assert lines[2].endswith(" 1.5 |")
