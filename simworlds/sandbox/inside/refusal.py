# SPDX-License-Identifier: GPL-3.0-or-later
"""The exception of a tool that cannot do what is wanted."""


class Refused(Exception):  # noqa: N818 - reads as the state it names
    """The tool cannot do this; the message says why, and what to do."""
