"""Do both forms of one manual give the same pages? ``python -m measurements.page_forms RST_DIR HTML_DIR``."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from kb_build.pages.readers.html import read_html
from kb_build.pages.readers.rst import read_rst
from measurements.reader_comparison import ReaderComparison, compare


def main() -> None:
    """Read both folders, print how far they agree, and what differs most."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rst", type=Path, help="folder with the RST sources' index.rst")
    parser.add_argument("html", type=Path, help="folder with the download's index.html")
    parser.add_argument("--version", default="4.4", help="the documentation's version (default: 4.4)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    parser.add_argument(
        "--show", type=int, default=20, help="how many pages that differ to list (default: 20)"
    )
    options = parser.parse_args()
    began = time.perf_counter()
    sources = read_rst(options.rst, source="manual", version=options.version, jobs=options.jobs)
    between = time.perf_counter()
    download = read_html(options.html, source="manual", version=options.version, jobs=options.jobs)
    ended = time.perf_counter()
    print(f"RST:  {len(sources)} pages in {between - began:.1f} s")
    print(f"HTML: {len(download)} pages in {ended - between:.1f} s")
    report(compare(sources, download), options.show)


def report(comparison: ReaderComparison, show: int) -> None:
    """Print a comparison and its ``show`` least similar pages."""
    shared = len(comparison.shared)
    print(
        f"shared pages: {shared}; only RST: {list(comparison.only_first)}; only HTML: {list(comparison.only_second)}"
    )
    print(f"title and section titles agree: {comparison.outline_share:.2%}")
    print(
        f"mean token similarity: {comparison.similarity:.4f}; equal text: {comparison.identical / max(1, shared):.2%}"
    )
    for name in ("children", "breadcrumbs", "links", "anchors"):
        print(f"same {name}: {getattr(comparison, f'same_{name}') / max(1, shared):.2%}")
    for row in comparison.differences[:show]:
        print(f"- {row.slug}: {row.similarity:.3f}")
        if not row.outline_agrees:
            first, second = (set(outline) for outline in row.outlines)
            print(f"    outline: only RST {sorted(first - second)}; only HTML {sorted(second - first)}")
        print(f"    only RST: {' '.join(row.lost[:20])}\n    only HTML: {' '.join(row.added[:20])}")


if __name__ == "__main__":
    main()
