"""The command `tokosen` that comes with the package: the same program as that of the Rust package."""

import signal
import sys

from tokosen import _tokosen


def main() -> None:
    """Runs the program with the arguments of this process."""
    # The program handles Ctrl-C itself, and removes its unfinished files.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_tokosen.program(["tokosen", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
