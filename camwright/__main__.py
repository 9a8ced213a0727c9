"""The command ``camwright``, and ``python -m camwright``: the command line, ended quietly while it is still imported."""

import sys
from pathlib import Path

# with ``-m`` the folder where it is run comes first, and a script there called ``numbers.py`` would stand for Python's own
if sys.path[:1] == [str(Path.cwd())] and Path(__file__).parent.parent != Path.cwd():
    del sys.path[0]

try:
    from camwright.cli.main import main
except KeyboardInterrupt:
    sys.exit(130)

if __name__ == "__main__":
    sys.exit(main())
