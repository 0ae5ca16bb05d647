# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file cannot be looked at for."""


class Refused(Exception):  # noqa: N818 - reads as the state it names
    """The message says why."""
