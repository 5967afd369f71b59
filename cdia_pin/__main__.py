"""``python -m cdia_pin`` is the command ``cdia``."""

import sys

from cdia_pin.cli import main

if __name__ == "__main__":
    sys.exit(main())
