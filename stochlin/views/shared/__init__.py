"""Shared by all commands and pictures: options, screen, words, style."""
