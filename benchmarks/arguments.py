"""Arguments of scripts that simulate for long and can be resumed."""

import argparse
from pathlib import Path


def file_and_work(description):
    """The file that is written, and the folder in which what is done already is kept."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("file", type=Path)
    parser.add_argument("--work", type=Path, required=True)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    return options
