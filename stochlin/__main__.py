"""The command line where no script is installed: ``python -m stochlin``."""

from stochlin.views.command import main

if __name__ == "__main__":
    main()
