"""Tables in files: texts with separators, and workbooks."""
