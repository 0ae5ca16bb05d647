"""Every way of attack, by what it is aimed at."""
