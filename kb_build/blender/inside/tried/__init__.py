# SPDX-License-Identifier: GPL-3.0-or-later
"""What assigning to new things and calling their functions tells: taken, refused, without effect, a crash."""
