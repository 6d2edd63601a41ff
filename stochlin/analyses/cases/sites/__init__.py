"""The site of a case file: design spectrum, records, and intensity of the shaking."""
