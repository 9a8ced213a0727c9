"""The command ``camwright``, and ``python -m camwright``: the command line, ended quietly while it is still imported."""

import sys

try:
    from camwright.cli.main import main
except KeyboardInterrupt:
    sys.exit(130)

if __name__ == "__main__":
    sys.exit(main())
