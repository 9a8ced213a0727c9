"""The example in docs/bender.md."""

import doctest
from pathlib import Path


def test_documentation_example():
    path = Path(__file__).parents[2] / "docs" / "bender.md"
    text = path.read_text(encoding="utf-8").replace("```", "")
    runner = doctest.DocTestRunner()
    runner.run(doctest.DocTestParser().get_doctest(text, {}, "bender.md", str(path), 0))
    assert runner.tries > 10
    assert runner.failures == 0
