# SPDX-License-Identifier: GPL-3.0-or-later
"""Which operators there are, and what each of them takes."""
