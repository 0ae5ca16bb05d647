"""``python -m measurements``: measures this project."""

from __future__ import annotations

import sys

from measurements.main import main

if __name__ == "__main__":
    sys.exit(main())
