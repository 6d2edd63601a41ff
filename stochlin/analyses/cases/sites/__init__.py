"""What a case file says of its site: spectrum, records, how strong the shaking is."""
