"""What all commands and pictures share: options, screen, words, style."""
