"""Buildings as other programs print them: tables of modes."""
