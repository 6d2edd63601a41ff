"""Scripts of the cases are run by the tests, and not by whoever looks for tests in them."""

collect_ignore_glob = ["*/case.py", "*/independent.py", "opensees_frames.py"]
