"""Makes the modules that the tests of the tables share importable, in whatever mode pytest imports the tests."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parent))
