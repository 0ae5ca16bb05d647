"""What a client starts in the bundle: the documentation server, on stdio."""

from simworlds.cli import main

if __name__ == "__main__":
    main(["serve"], prog_name="simworlds")
