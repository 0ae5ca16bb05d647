# SPDX-License-Identifier: GPL-3.0-or-later
"""What must be so before an operator runs: the active object, its mode, the area, an undo step."""
