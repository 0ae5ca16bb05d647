# SPDX-License-Identifier: GPL-3.0-or-later
"""What a tool raises when it cannot do as asked."""


class Refused(Exception):  # noqa: N818 - reads as the state it names
    """The caller asked for something that cannot be had; the message says why, and what to do."""
