"""The golden run: what every command says and writes, recorded once and compared after a change that must not change it.

    python tests/golden record BEFORE.jsonl --root OTHER_CHECKOUT
    python tests/golden compare BEFORE.jsonl
    python tests/golden compare BEFORE.jsonl AFTER.jsonl

``record`` runs every case and records, for each: exit code, the answer on standard output (parsed if it is JSON), the text on
standard error, and the SHA-256 of each file that it wrote. A record has one line a case, written as soon as the case ends: a run
that was killed goes on where it stopped with the same command. ``compare`` runs the cases again or takes a second record, prints each
difference (key path, before, after), and ends with 1 if there is one. All cases take more than an hour, the slowest come last;
``--only`` and ``--fast`` choose.

Each case runs in one scratch directory, with relative paths, so the record does not depend on where that is. All files
that a case reads are copied there or made here. Files carry the version of camwright: with another version their hashes
differ. ``--keep`` keeps the files of a run, to see what differs.

No record is kept in the repository: hashes hold for one kind of processor and one set of libraries (see docs/contract.md), and every
wanted change of an answer would have to replace it. The record of any commit is made in a checkout of that commit.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path

from cases import all_cases
from comparing import compare
from record import Record, code_of
from running import chosen, run_all, tell


def main() -> int:
    """Run the command line.

    Returns
    -------
    int
        0 done, 1 something differs.
    """
    parser = argparse.ArgumentParser(description="Record what every command says, or compare with such a record.")
    parser.add_argument("what", choices=("record", "compare", "list"))
    parser.add_argument("record", type=Path, metavar="RECORD.jsonl", nargs="?", help="the record; not needed to list")
    parser.add_argument(
        "after", type=Path, metavar="AFTER.jsonl", nargs="?", help="compare with this record, run nothing"
    )
    default = shlex.join([sys.executable, "-m", "camwright"])
    parser.add_argument("--command", default=default, help="how camwright is started; paths must be absolute")
    parser.add_argument(
        "--root", type=Path, default=Path(__file__).resolve().parents[2], help="repository with the examples"
    )
    parser.add_argument("--only", metavar="SUBSTRING", help="only cases whose name has it")
    parser.add_argument("--fast", action="store_true", help="leave out the slowest cases")
    parser.add_argument(
        "--keep", type=Path, metavar="DIR", help="keep the files of the run here; replaced if it is there"
    )
    options = parser.parse_args()
    if options.what == "list":
        examples = {
            file.stem: file.read_text(encoding="utf-8") for file in sorted((options.root / "examples").glob("*.toml"))
        }
        for case in chosen(all_cases(examples), options.only, fast=options.fast):
            tell(f"{case.name}: {shlex.join(case.arguments)}", sys.stdout)
        return 0
    if options.record is None:
        parser.error("name the record")
    if options.what == "record":
        run_all(options, Record(options.record, code_of(options.root, options.command)))
        return 0
    before = Record(options.record).cases
    if options.after is not None:
        after = Record(options.after).cases
        names = [name for name in before if name in after and (options.only is None or options.only in name)]
    else:
        fresh = Record(None)
        wanted = run_all(options, fresh)
        after = fresh.cases
        # a case that is no longer listed counts only where everything was run
        gone = [] if options.fast else [name for name in before if options.only is None or options.only in name]
        names = [*dict.fromkeys([*(case.name for case in wanted), *gone])]
    found = compare(before, after, names)
    for text in (*found, f"{len(found)} differences in {len(names)} cases"):
        tell(text, sys.stdout)
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
