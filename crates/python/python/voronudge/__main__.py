"""The program: ``python -m voronudge infer …``."""

import sys

from ._native import run

if __name__ == "__main__":
    sys.exit(run(["voronudge", *sys.argv[1:]]))
