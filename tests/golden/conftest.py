"""The golden run is a program of its own, run by its folder's name; only its tests are collected."""

collect_ignore = ["__main__.py", "cases.py", "comparing.py", "inputs.py", "record.py", "running.py"]
