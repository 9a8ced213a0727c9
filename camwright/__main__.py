"""``python -m camwright``: the command line."""

import sys

from camwright.cli.main import main

sys.exit(main())
