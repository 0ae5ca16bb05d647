"""``python -m kb_build.ready VERSION --from SOURCE --home FOLDER``: what a server fetches a base with.

Progress goes to stderr, line by line; so does the error that it ends with.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from kb_build.errors import FetchedElsewhere
from kb_build.ready.fetch import fetch_base, is_one_file
from simworlds.errors import UserError
from simworlds.terminal.progress import shown_progress
from simworlds.terminal.termination import unwind_on_termination

_ELSEWHERE = 3


def main() -> int:
    """Fetches one base. Returns 0, 1 when it failed, or 3 when another process is fetching."""
    parser = argparse.ArgumentParser(prog="python -m kb_build.ready", description=__doc__)
    parser.add_argument("version")
    parser.add_argument("--from", dest="source", required=True)
    parser.add_argument(
        "--any", action="store_true", help="Take a single file for whichever version it is of."
    )
    parser.add_argument("--home", type=Path, required=True)
    given = parser.parse_args()
    unwind_on_termination()
    version = "" if given.any and is_one_file(given.source) else given.version
    try:
        with shown_progress() as progress:
            fetch_base(version, given.source, home=given.home, progress=progress)
    except FetchedElsewhere:
        return _ELSEWHERE
    except UserError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
