"""What a client starts in the bundle: the documentation server, on stdio."""

from simworlds.cli import main

main(["serve"], prog_name="simworlds")
