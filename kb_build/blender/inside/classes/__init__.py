# SPDX-License-Identifier: GPL-3.0-or-later
"""What classes have: by RNA, by the context that is an instance of one, and by their own sources."""
