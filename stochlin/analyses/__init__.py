"""Second floor: the verbs. Models in, labelled datasets out."""
