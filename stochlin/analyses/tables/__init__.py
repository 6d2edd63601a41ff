"""What every labelled table needs: names and units, broadcasting, checks, files."""
