"""The four roles: who plans, who builds, who looks, and who judges the result."""
