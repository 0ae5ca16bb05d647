"""``python -m simworlds``: the command, where its script is not on PATH."""

from simworlds.cli import main

if __name__ == "__main__":
    main(prog_name="simworlds")
